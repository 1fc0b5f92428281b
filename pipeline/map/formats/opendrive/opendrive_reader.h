// Makes a map from an OpenDRIVE file.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/formats/map_builder.h"

namespace bevloc {

/// - Road boundaries: borders between a paved lane (driving, shoulder, parking and so on) and one
///   that is not (sidewalk, none, median and so on) or no lane, unless another road's paved lanes
///   continue there, as in junctions; and road marks of type curb, grass and edge.
/// - Lane dividers: other road marks, by their type, at the mean tOffset of their lines and their
///   sway from the border of the lane.
/// - Pedestrian crossings: objects of type crosswalk, or without a type and with a name that says
///   so, and their copies, by their outlines, or by length and width.
/// - Lanes: lanes on which vehicles drive, one for each lane section.
///
/// Heights are those of the elevation profile; without a profile there are none. The place on earth
/// comes from the header's geoReference (projection.h) with its offset. HdMap::left_out names parts
/// that are lost because a road contradicts itself, such as gaps in its reference line, and unused
/// objects with bad numbers. A map whose middle is more than 400 km from the meridian of the
/// geoReference gets a remark. Fails
/// - as parse_document() does;
/// - on a bad number of an object that a class table takes;
/// - on a geoReference that cannot be read, or from whose meridian the map is too far away, unless
///   the options give an origin.
Result<ImportedMap> parse_opendrive(std::string_view text, const std::filesystem::path& file,
                                    const ImportOptions& options);

}  // namespace bevloc
