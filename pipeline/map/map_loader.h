// Loads a map file of any supported format.
#pragma once

#include <filesystem>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Loads a map of any format that formats/map_format.h knows, without the report of its import.
/// Fails on a map in which nothing can be localized, too (map_check.h).
Result<HdMap> load_map(const std::filesystem::path& path);

}  // namespace bevloc
