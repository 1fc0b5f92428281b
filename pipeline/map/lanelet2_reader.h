// Reads HD maps in the OSM format of Lanelet2, including Autoware's variant.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/formats/map_builder.h"

namespace bevloc {

/// Reads the text of a Lanelet2 map. Uses these parts (tags as documented in Lanelet2's
/// LinestringTagging.md and LaneletAndAreaTagging.md):
/// - Lane dividers: ways of type line_thin and line_thick, unless they bound a crosswalk, or only
///   lanelets for others than vehicles, or are road boundaries (below); ways without a type that
///   bound two or more lanelets for vehicles, or run beside a bound of another one.
/// - Pedestrian crossings: the area between the bounds of lanelets of subtype crosswalk.
/// - Road boundaries: ways of type curbstone, road_border, guard_rail, jersey_barrier, wall, fence
///   and hedge; other ways without a type that bound one lanelet for vehicles, unless they run on
///   one of the former; ways of type line_thin and line_thick that bound one lanelet for vehicles
///   and have no other line beside them, because then they are the edge of the road.
/// - Lanes: lanelets for vehicles, in both directions if one_way=no.
///
/// A bound of a lanelet may be several ways that join; each keeps its own type. Ignores everything
/// else, such as virtual lines, stop lines and signs. locate_nodes() (map_frame.h) defines the map
/// frame.
///
/// A lanelet or way that cannot be used (missing elements, far places, bounds that do not join) is
/// left out, and HdMap::left_out names it with file and line.
///
/// Fails with file, line and element on text that is not OSM XML, on bad coordinates, and on a file
/// without any part listed above that can be used.
///
/// Error messages show `file`; its stem becomes the name of the map. The report is by kind of way
/// ("way line_thin dashed"). A class table may also take ways that are otherwise ignored. The
/// options may give an origin only for a file that has nothing but local coordinates; with an
/// origin, any other file is refused.
Result<ImportedMap> parse_lanelet2(std::string_view text, const std::filesystem::path& file,
                                   const ImportOptions& options);

}  // namespace bevloc
