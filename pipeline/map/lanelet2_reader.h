// Reads HD maps in Lanelet2's OSM format, Autoware's dialect included.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// What becomes of a Lanelet2 map (tags as documented in Lanelet2's LinestringTagging.md and
/// LaneletAndAreaTagging.md):
/// - Lane dividers: ways line_thin and line_thick that bound a lanelet for vehicles and no
///   crosswalk; ways without a type that bound two or more lanelets for vehicles.
/// - Crossings: lanelets of subtype crosswalk, the area between their bounds.
/// - Road boundaries: ways curbstone, road_border, guard_rail, jersey_barrier, wall, fence and
///   hedge; ways without a type that bound a single lanelet for vehicles.
/// - Lanes: lanelets for vehicles, in both directions where one_way=no.
///
/// All else (virtual lines, stop lines, signs) is left out. The map frame is that of locate_nodes()
/// (map_frame.h).
///
/// Fails with file, line and element on text that is not OSM XML, on bad coordinates, on references
/// to elements that are not there, and if nothing in the file is of use.
Result<HdMap> read_lanelet2(const std::filesystem::path& path);

/// The same for text that is there already; `file` stands in messages and names the map.
Result<HdMap> parse_lanelet2(std::string_view text, const std::filesystem::path& file);

}  // namespace bevloc
