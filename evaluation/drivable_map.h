// Loads the maps that simulated vehicles drive through.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/result.h"
#include "pipeline/map/map_loader.h"

namespace bevloc::evaluation {

/// Loads a map as load_map() does. Fails also if it has no lanes.
inline Result<HdMap> load_drivable_map(const std::filesystem::path& file) {
  auto map = load_map(file);
  if (map && map->lanes.empty()) {
    return fail("{}: found no lanes, wanted some to drive on", file.string());
  }
  return map;
}

/// Fails if no vehicle can drive through one of these maps. A command that runs long calls it
/// before its first drive, so that no result is lost because of a later map.
inline Status check_drivable(const std::vector<std::string>& maps) {
  for (const std::string& file : maps) {
    if (const auto map = load_drivable_map(file); !map) return tl::unexpected(map.error());
  }
  return {};
}

}  // namespace bevloc::evaluation
