// Loads a map file of any supported format.
#pragma once

#include <filesystem>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Loads a compact map, recognised by its magic number, or a Lanelet2 map, recognised by the
/// extension .osm.
Result<HdMap> load_map(const std::filesystem::path& path);

}  // namespace bevloc
