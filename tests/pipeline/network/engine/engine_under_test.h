// The engine that a test program tests. Each program links one file of under_test/, which defines
// engine_under_test().
#pragma once

#include <string>

#include "pipeline/network/engine/engine.h"

namespace bevloc::test {

struct EngineUnderTest {
  std::string name;  ///< unique per program, because names of temporary files contain it
  IsaCap isa = IsaCap::kBest;
  bool own_kernels = true;
};

const EngineUnderTest& engine_under_test();

}  // namespace bevloc::test
