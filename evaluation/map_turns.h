// Lets every second drive of an evaluation go through one of several maps.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"

namespace bevloc::evaluation {

/// The map of a drive, which is counted from 0: every second drive goes through one of `maps`, in
/// turn. Empty if the drive goes through a procedural town.
inline std::string map_of_drive(const std::vector<std::string>& maps, int drive) {
  if (maps.empty() || drive % 2 == 0) return "";
  return maps[static_cast<size_t>(drive) / 2 % maps.size()];
}

/// Fails if the drives are too few to go through each map. `option`: names the number of drives.
inline Status check_map_turns(const std::vector<std::string>& maps, std::string_view option,
                              int drives) {
  const size_t wanted = 2 * maps.size();
  if (static_cast<size_t>(drives) >= wanted) return {};
  return fail(
      "--map: found {} of them with {} {}, wanted {} {} or more, because only every second drive "
      "goes through a map",
      maps.size(), option, drives, option, wanted);
}

}  // namespace bevloc::evaluation
