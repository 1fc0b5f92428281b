// Keeps evaluations away from the towns that networks train on.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "common/result.h"
#include "sim/world/world_generator.h"

namespace bevloc::evaluation {

/// Fails if one of `count` seeds from `first` on is a town of training. `option`: names `first`.
inline Status check_town_seeds(std::string_view option, uint64_t first, uint64_t count = 1) {
  if (first < sim::kFirstTrainingSeed && count <= sim::kFirstTrainingSeed - first) return {};
  // The last seed, or `first` if the sum overflows.
  const uint64_t found = std::max(first, first + (count - 1));
  return fail("{}: found the town {}, wanted seeds below {}, because networks train on the others",
              option, found, sim::kFirstTrainingSeed);
}

}  // namespace bevloc::evaluation
