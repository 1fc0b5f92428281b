// oneDNN and our own kernels with the best instructions of this CPU.
#include "pipeline/network/engines/onednn/onednn_engine.h"
#include "tests/pipeline/network/engines/engine_under_test.h"

namespace bevloc::test {

const EngineUnderTest& engine_under_test() {
  static const EngineUnderTest engine{.name = "onednn_best",
                                      .make = nn::make_onednn_engine,
                                      .cap_refusal = "instruction set of oneDNN is already fixed"};
  return engine;
}

}  // namespace bevloc::test
