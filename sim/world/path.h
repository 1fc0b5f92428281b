// Lines on the ground: arc length, parallel lines, rounded corners.
#pragma once

#include <functional>

#include "common/plane.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// The vector turned by 90 degrees to the left.
inline Eigen::Vector2d left_of(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

/// The unit vector at an angle to the x axis.
inline Eigen::Vector2d unit_vector(double angle_rad) {
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

/// A polyline parametrised by station (arc length in metres). The direction is interpolated between
/// the vertices, so that headings and parallel lines are smooth. Immutable, and so thread-safe.
class Path {
 public:
  Path() = default;
  /// Drops each point that coincides with the one before; at least two points must remain.
  explicit Path(const Polyline& points);

  double length_m() const { return stations_.back(); }
  const Polyline& points() const { return points_; }
  bool empty() const { return points_.empty(); }

  /// Beyond the ends the path continues straight.
  Eigen::Vector2d position(double station_m) const;
  /// The unit vector along the path; constant beyond the ends.
  Eigen::Vector2d direction(double station_m) const;
  double heading_rad(double station_m) const;
  /// The point `right_m` to the right of the path (left if negative).
  Eigen::Vector2d beside(double station_m, double right_m) const;

  Path reversed() const;

  /// The line `right_m(station)` metres to the right of the path, from one station to another. It
  /// has a point at least every metre in bends and no inner points on straights.
  Polyline parallel(double from_m, double to_m, const std::function<double(double)>& right_m) const;
  Polyline parallel(double from_m, double to_m, double right_m) const;

 private:
  struct Place {
    size_t segment;
    double fraction;  ///< share of the segment; below 0 or above 1 beyond the ends
  };
  Place place_at(double station_m) const;
  Eigen::Vector2d position(const Place& place) const;
  Eigen::Vector2d direction(const Place& place) const;

  Polyline points_;
  std::vector<Eigen::Vector2d> directions_;  ///< directions at the points
  std::vector<double> stations_;             ///< stations of the points
};

/// A route counts each lane as at least this long, so that a route along lanes of length 0 ends.
inline constexpr double kLeastStep_m = 0.01;

/// Drops the points that lie on the straight between their neighbours.
Polyline without_collinear(const Polyline& line);

/// A smooth curve that leaves p0 along the unit vector d0 and arrives at p1 along d1: a straight
/// and an arc if the two tangents meet ahead of p0, otherwise an S. It has a point at least every
/// 0.8 m.
Polyline smooth_turn(const Eigen::Vector2d& p0, const Eigen::Vector2d& d0,
                     const Eigen::Vector2d& p1, const Eigen::Vector2d& d1);

/// A smooth line past waypoints: straights joined by arcs. The arc at waypoint i begins and ends
/// `tangent_m[i]` from it; the first and the last value are ignored.
Polyline rounded(const Polyline& waypoints, const std::vector<double>& tangent_m);

/// Rises smoothly (cubic) from 0 at `begin` to 1 at `end`.
double smooth_step(double begin, double end, double value);

/// Appends `tail` to `line`; drops points that coincide with the one before.
void append(Polyline& line, const Polyline& tail);

Polyline reversed(Polyline line);

}  // namespace bevloc::sim
