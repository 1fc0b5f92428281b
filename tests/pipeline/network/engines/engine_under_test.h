// Describes the engine that a test program tests. Each program links one file of under_test/, which
// defines engine_under_test().
#pragma once

#include <string>

#include "pipeline/network/engines/engine.h"

namespace bevloc::test {

struct EngineUnderTest {
  std::string name;  ///< unique per program, because names of temporary files contain it
  nn::MakeEngine* make = nullptr;
  IsaCap isa = IsaCap::kBest;
  bool own_kernels = true;
  std::string cap_refusal;  ///< part of the error message for a cap other than `isa`
};

const EngineUnderTest& engine_under_test();

}  // namespace bevloc::test
