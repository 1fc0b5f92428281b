// oneDNN without our own kernels.
#include "pipeline/network/engines/onednn/onednn_engine.h"
#include "tests/pipeline/network/engines/engine_under_test.h"

namespace bevloc::test {

const EngineUnderTest& engine_under_test() {
  static const EngineUnderTest engine{.name = "onednn_alone",
                                      .make = nn::make_onednn_engine,
                                      .own_kernels = false,
                                      .cap_refusal = "instruction set of oneDNN is already fixed"};
  return engine;
}

}  // namespace bevloc::test
