// A solver's name as GoogleTest takes it.
#pragma once

#include <algorithm>
#include <string>

#include "pipeline/solver/solver_factory.h"

namespace bevloc {

/// Of a parameter that has a field `kind`.
inline constexpr auto kSolverName = [](const auto& test) {
  std::string name(name_of(test.param.kind));
  std::ranges::replace_if(
      name, [](char c) { return c == '-' || c == '+'; }, '_');
  return name;
};

}  // namespace bevloc
