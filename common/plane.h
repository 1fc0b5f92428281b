// Geometry of vectors, line segments and polylines in the plane.
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

namespace bevloc {

using Polyline = std::vector<Eigen::Vector2d>;

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

/// The length of a line in metres.
inline double polyline_length(const Polyline& line) {
  double length_m = 0.0;
  for (size_t i = 1; i < line.size(); ++i) length_m += (line[i] - line[i - 1]).norm();
  return length_m;
}

/// Whether a ray from `point` to the east crosses the ring an odd number of times (even-odd rule).
/// The points of the ring may have heights, which do not count.
template <typename Point>
bool is_in_ring(const Eigen::Vector2d& point, const std::vector<Point>& ring) {
  bool inside = false;
  for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Point& a = ring[i];
    const Point& b = ring[j];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    const double x = a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (point.x() < x) inside = !inside;
  }
  return inside;
}

}  // namespace bevloc
