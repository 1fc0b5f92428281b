// oneDNN and our own kernels, capped to AVX2 without VNNI.
#include "tests/pipeline/network/engine/engine_under_test.h"

namespace bevloc::test {

const EngineUnderTest& engine_under_test() {
  static const EngineUnderTest engine{.name = "onednn_avx2", .isa = IsaCap::kAvx2};
  return engine;
}

}  // namespace bevloc::test
