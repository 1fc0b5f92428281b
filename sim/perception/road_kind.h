// Classifies the road around a vehicle from the lines of the map.
#pragma once

#include <cstdint>
#include <optional>

#include "common/se2.h"
#include "pipeline/map/map_index.h"
#include "sim/perception/dashed_line.h"

namespace bevloc::sim {

/// Kinds of road that differ in the evidence they give for matching.
enum class RoadKind : uint8_t {
  /// Only parallel straight lines through the whole box: no evidence along the road.
  kStraightSolid = 0,
  /// A straight road with a crossing, dashes, or lines that begin, end or have a kink.
  kStraightStructured = 1,
  /// All long lines bend by more than 10 degrees.
  kCurve = 2,
  /// A kerb turns around a corner.
  kJunction = 3,
  /// The island of a roundabout, or one road edge shifts by a lane while other lines stay straight.
  kMergeOrRoundabout = 4,
};
inline constexpr int kRoadKinds = 5;

const char* name(RoadKind kind);

/// Classifies the road around a pose by the map elements within the raster's box. For
/// kStraightSolid a larger box must qualify, because the box at the prior may show more. Returns
/// nothing if there is too little line or the road lies between two kinds. `dashes` belong to the
/// index's map. They only distinguish straight roads: a road that is kStraightSolid apart from its
/// dashes is kStraightStructured.
std::optional<RoadKind> road_kind(const MapIndex& index, const Se2& map_from_vehicle,
                                  const MapDashes& dashes = {});

}  // namespace bevloc::sim
