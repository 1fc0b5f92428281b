// Reads HD maps in the OSM format of Lanelet2, including Autoware's variant.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Reads a Lanelet2 map. Uses these parts (tags as documented in Lanelet2's LinestringTagging.md
/// and LaneletAndAreaTagging.md):
/// - Lane dividers: ways of type line_thin and line_thick that bound a lanelet for vehicles but no
///   crosswalk; ways without a type that bound two or more lanelets for vehicles.
/// - Pedestrian crossings: the area between the bounds of lanelets of subtype crosswalk.
/// - Road boundaries: ways of type curbstone, road_border, guard_rail, jersey_barrier, wall, fence
///   and hedge; ways without a type that bound one lanelet for vehicles.
/// - Lanes: lanelets for vehicles, in both directions if one_way=no.
///
/// Ignores everything else, such as virtual lines, stop lines and signs. locate_nodes()
/// (map_frame.h) defines the map frame.
///
/// Fails with file, line and element on text that is not OSM XML, on bad coordinates, on references
/// to missing elements, and on a file without any part listed above.
Result<HdMap> read_lanelet2(const std::filesystem::path& path);

/// The same for text in memory. Error messages show `file`; its stem becomes the name of the map.
Result<HdMap> parse_lanelet2(std::string_view text, const std::filesystem::path& file);

}  // namespace bevloc
