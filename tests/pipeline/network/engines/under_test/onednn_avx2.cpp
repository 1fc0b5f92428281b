// oneDNN and our own kernels, capped to AVX2 without VNNI.
#include "pipeline/network/engines/onednn/onednn_engine.h"
#include "tests/pipeline/network/engines/engine_under_test.h"

namespace bevloc::test {

const EngineUnderTest& engine_under_test() {
  static const EngineUnderTest engine{.name = "onednn_avx2",
                                      .make = nn::make_onednn_engine,
                                      .isa = IsaCap::kAvx2,
                                      .cap_refusal = "instruction set of oneDNN is already fixed"};
  return engine;
}

}  // namespace bevloc::test
