// Geometry of vectors and line segments in the plane.
#pragma once

#include <algorithm>

#include <Eigen/Core>

namespace bevloc {

/// Cross product of two plane vectors. It is positive if b points to the left of a.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Distance from `point` to the segment `from`-`to`. The ends of the segment may coincide.
inline double distance_to_segment(const Eigen::Vector2d& point, const Eigen::Vector2d& from,
                                  const Eigen::Vector2d& to) {
  const Eigen::Vector2d direction = to - from;
  const double length_squared = direction.squaredNorm();
  if (length_squared == 0.0) return (point - from).norm();
  const double along = std::clamp((point - from).dot(direction) / length_squared, 0.0, 1.0);
  return (point - from - along * direction).norm();
}

}  // namespace bevloc
