// Reads the map expansion of nuScenes (expansion/*.json, version 1.0 to 1.3).
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/formats/map_builder.h"

namespace bevloc {

/// - Lane dividers: lane_divider and road_divider, each cut where its segment type changes;
///   segments of type NIL are not painted.
/// - Pedestrian crossings: ped_crossing.
/// - Road boundaries: the outline of all drivable_area polygons together.
/// - Lanes: the curves of arcline_path_3, 3.5 m wide, with the successors of connectivity.
///
/// The place on earth comes from the name of the file (boston-seaport.json and so on). Fails with
/// file, line and path on references to missing nodes and on bad numbers.
Result<ImportedMap> parse_nuscenes(std::string_view text, const std::filesystem::path& file,
                                   const ImportOptions& options);

}  // namespace bevloc
