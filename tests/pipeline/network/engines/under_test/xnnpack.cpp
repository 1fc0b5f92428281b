// XNNPACK.
#include "pipeline/network/engines/xnnpack/xnnpack_engine.h"
#include "tests/pipeline/network/engines/engine_under_test.h"

namespace bevloc::test {

const EngineUnderTest& engine_under_test() {
  static const EngineUnderTest engine{.name = "xnnpack",
                                      .make = nn::make_xnnpack_engine,
                                      .cap_refusal = "XNNPACK selects its instructions itself"};
  return engine;
}

}  // namespace bevloc::test
