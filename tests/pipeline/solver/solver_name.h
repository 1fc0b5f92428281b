// Names of solvers in the names of parameterised tests.
#pragma once

#include <algorithm>
#include <string>

#include "pipeline/solver/solver_factory.h"

namespace bevloc {

/// Name generator for INSTANTIATE_TEST_SUITE_P, for parameters with a member `kind`. GoogleTest
/// allows only letters, digits and underscores.
inline constexpr auto kSolverName = [](const auto& test) {
  std::string name(name_of(test.param.kind));
  std::ranges::replace_if(
      name, [](char c) { return c == '-' || c == '+'; }, '_');
  return name;
};

}  // namespace bevloc
