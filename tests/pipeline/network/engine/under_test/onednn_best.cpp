// oneDNN and our own kernels with the best instructions of this CPU.
#include "tests/pipeline/network/engine/engine_under_test.h"

namespace bevloc::test {

const EngineUnderTest& engine_under_test() {
  static const EngineUnderTest engine{.name = "onednn_best"};
  return engine;
}

}  // namespace bevloc::test
