// Plane geometry for the tests of the simulator.
#pragma once

#include <algorithm>
#include <limits>

#include "common/plane.h"
#include "sim/world/path.h"

namespace bevloc::sim {

/// Whether the open segments a-b and c-d cross.
inline bool segments_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                           const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q,
                       const Eigen::Vector2d& r) { return cross(q - p, r - p); };
  return side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
}

/// Whether two polylines cross. Sets `place`, if given, to a point near the crossing.
inline bool lines_cross(const Polyline& a, const Polyline& b, Eigen::Vector2d* place = nullptr) {
  for (size_t i = 1; i < a.size(); ++i) {
    const Eigen::Vector2d low = a[i - 1].cwiseMin(a[i]);
    const Eigen::Vector2d high = a[i - 1].cwiseMax(a[i]);
    for (size_t k = 1; k < b.size(); ++k) {
      if ((b[k - 1].cwiseMax(b[k]).array() < low.array()).any()) continue;
      if ((b[k - 1].cwiseMin(b[k]).array() > high.array()).any()) continue;
      if (!segments_cross(a[i - 1], a[i], b[k - 1], b[k])) continue;
      if (place != nullptr) *place = a[i];
      return true;
    }
  }
  return false;
}

inline double distance_to_line(const Eigen::Vector2d& point, const Polyline& line) {
  double nearest = std::numeric_limits<double>::max();
  for (size_t i = 1; i < line.size(); ++i) {
    nearest = std::min(nearest, distance_to_segment(point, line[i - 1], line[i]));
  }
  return nearest;
}

}  // namespace bevloc::sim
