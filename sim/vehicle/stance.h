// How a vehicle stands: the ground around it, and its body over its wheels.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "common/se2.h"
#include "sim/vehicle/body_motion.h"

namespace bevloc::sim {

/// The curvature of the ground in the vehicle frame: half of it times the squared distance is the
/// height above the plane on which the vehicle stands. A constant grade is no curvature.
struct GroundShape {
  double along_per_m = 0.0;   ///< along the road ahead; positive for a sag, negative for a crest
  double across_per_m = 0.0;  ///< positive if the ground rises to both sides
  double twist_per_m = 0.0;   ///< change of the bank; positive if the left side rises ahead

  bool is_flat() const { return along_per_m == 0.0 && across_per_m == 0.0 && twist_per_m == 0.0; }
};

/// Farther from the vehicle the ground goes on with a constant grade.
inline constexpr double kCurvedReach_m = 60.0;

/// The height of the ground around a vehicle at a pose.
class CurvedGround {
 public:
  CurvedGround() = default;
  CurvedGround(const GroundShape& shape, const Se2& map_from_vehicle)
      : shape_(shape), vehicle_from_map_(map_from_vehicle.inverse()) {}

  const GroundShape& shape() const { return shape_; }

  /// The height of the ground at a place in the map, above the plane on which the vehicle stands.
  double height_m(const Eigen::Vector2d& place) const {
    if (shape_.is_flat()) return 0.0;
    const Eigen::Vector2d point = vehicle_from_map_ * place;
    const double distance_m = point.norm();
    const double bend = 0.5 * (shape_.along_per_m * point.x() * point.x() +
                               shape_.across_per_m * point.y() * point.y()) +
                        shape_.twist_per_m * point.x() * point.y();
    if (distance_m <= kCurvedReach_m) return bend;
    const double share = kCurvedReach_m / distance_m;
    return bend * share * (2.0 - share);
  }

 private:
  GroundShape shape_;
  Se2 vehicle_from_map_;
};

struct Stance {
  BodyMotion body{};
  GroundShape ground{};
};

}  // namespace bevloc::sim
