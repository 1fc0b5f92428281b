// Loads a map file of any supported format.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Loads a compact map, recognised by its magic number, or a Lanelet2 map, recognised by the
/// extension .osm. Fails on a map in which nothing can be localized, too (map_check.h).
Result<HdMap> load_map(const std::filesystem::path& path);

/// The same for the bytes of a file in memory. `path` gives the extension and the name in messages.
Result<HdMap> parse_map(std::string_view bytes, const std::filesystem::path& path);

}  // namespace bevloc
