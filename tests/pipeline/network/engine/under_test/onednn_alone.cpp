// oneDNN without our own kernels.
#include "tests/pipeline/network/engine/engine_under_test.h"

namespace bevloc::test {

const EngineUnderTest& engine_under_test() {
  static const EngineUnderTest engine{.name = "onednn_alone", .own_kernels = false};
  return engine;
}

}  // namespace bevloc::test
