// Loads a map file of any supported format.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Loads a map of any format of map_formats() (formats/map_format.h), without the report of its
/// import. Fails on a map in which nothing can be localized, too (map_check.h).
Result<HdMap> load_map(const std::filesystem::path& path);

/// Does the same for the bytes of a file in memory. `path` gives the extension and the name in
/// messages.
Result<HdMap> parse_map(std::string_view bytes, const std::filesystem::path& path);

}  // namespace bevloc
