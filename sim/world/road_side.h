// Tells on which side of a road boundary the road is.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pipeline/map/hd_map.h"
#include "sim/world/path.h"

namespace bevloc::sim {

/// Immutable, and so thread-safe.
class RoadSide {
 public:
  /// Keeps no reference to the map.
  explicit RoadSide(const HdMap& map);

  struct Side {
    bool is_right = false;    ///< the road is on the right of the line
    double distance_m = 0.0;  ///< least distance to the centre line of a lane
  };
  /// Returns nothing if no lane is near.
  std::optional<Side> of(const Path& boundary) const;

 private:
  /// The nearest point of a centre line within reach.
  std::optional<Eigen::Vector2d> nearest_centre(const Eigen::Vector2d& point) const;

  std::unordered_map<uint64_t, Polyline> centres_;  ///< points of centre lines, by their cell
};

/// A road boundary that has a lane near.
struct RoadsideBoundary {
  size_t element;  ///< index into HdMap::elements
  Path path;
  RoadSide::Side side;
};

/// The road boundaries with a lane near that are at least `least_m` long, in the order of the map.
std::vector<RoadsideBoundary> boundaries_beside_road(const HdMap& map, double least_m = 0.0);

}  // namespace bevloc::sim
