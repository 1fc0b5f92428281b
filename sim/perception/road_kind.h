// What kind of road lies around a vehicle, told from the map's lines alone.
#pragma once

#include <cstdint>
#include <optional>

#include "common/se2.h"
#include "pipeline/map/map_index.h"
#include "sim/perception/dashed_line.h"

namespace bevloc::sim {

/// What a match can be decided by.
enum class RoadKind : uint8_t {
  /// Parallel straight lines right through the box: nothing tells where along the road it is.
  kStraightSolid = 0,
  /// A straight road with something across it, lines that begin, end or have a kink, or dashes.
  kStraightStructured = 1,
  /// Lines that bend by 10 degrees or more, and together.
  kCurve = 2,
  /// A kerb turns a corner.
  kJunction = 3,
  /// A roundabout's island, or one edge of a road moves over by a lane while others go straight on.
  kMergeOrRoundabout = 4,
};
inline constexpr int kRoadKinds = 5;

const char* name(RoadKind kind);

/// The kind of road around a pose, by the geometry of the map's elements in the raster's box there
/// (for kStraightSolid, in all that a box at the prior pose may show); none if there is hardly any
/// line, or if it lies between two kinds. `dashes`, those of the index's map, only tell straight
/// roads apart: one that would be kStraightSolid without them is kStraightStructured.
std::optional<RoadKind> road_kind(const MapIndex& index, const Se2& map_from_vehicle,
                                  const MapDashes& dashes = {});

}  // namespace bevloc::sim
