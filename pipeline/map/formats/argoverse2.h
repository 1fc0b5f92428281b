// Reads the vector maps of Argoverse 2 (log_map_archive_*.json).
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/formats/map_builder.h"

namespace bevloc {

/// - Lane dividers: painted bounds of lanes, each once ("lane mark SOLID_WHITE" and so on).
/// - Pedestrian crossings: the area between edge1 and edge2.
/// - Road boundaries: the outline of all drivable areas together, except where the outline cuts a
///   lane for vehicles at the end of the map, which means that it lies across the lane.
/// - Lanes: lane segments of type VEHICLE or BUS, with their successors.
///
/// Coordinates are those of the city. The city, and so the place on earth, comes from the name of
/// the file ("..._PIT_city_47896.json"); without it the origin is unknown. Fails with file, line
/// and path of the value that is wrong. A lane that cannot be used is left out.
Result<ImportedMap> parse_argoverse2(std::string_view text, const std::filesystem::path& file,
                                     const ImportOptions& options);

}  // namespace bevloc
