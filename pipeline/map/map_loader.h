// Opens a map file of any format that this project reads.
#pragma once

#include <filesystem>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Reads a compact map (told by its first bytes) or a Lanelet2 map (told by its ending, .osm).
Result<HdMap> load_map(const std::filesystem::path& path);

}  // namespace bevloc
