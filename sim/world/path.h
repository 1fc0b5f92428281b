// Curves on the ground: arc length, parallel lines, rounded corners.
#pragma once

#include <functional>

#include "common/plane.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// The vector turned a quarter turn to the left.
inline Eigen::Vector2d left_of(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

inline Eigen::Vector2d unit_vector(double angle_rad) {
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

/// A polyline with a station (arc length, metres) along it. Its direction is interpolated between
/// the vertices, so that parallel lines and headings are smooth.
class Path {
 public:
  Path() = default;
  /// Points that coincide with the one before are dropped; two distinct points must remain.
  explicit Path(const Polyline& points);

  double length_m() const { return stations_.back(); }
  const Polyline& points() const { return points_; }
  bool empty() const { return points_.empty(); }

  /// Beyond the ends the path goes on straight.
  Eigen::Vector2d position(double station_m) const;
  /// A unit vector; constant beyond the ends.
  Eigen::Vector2d direction(double station_m) const;
  double heading_rad(double station_m) const;
  /// The point `right_m` to the right of the path (left if negative).
  Eigen::Vector2d beside(double station_m, double right_m) const;

  Path reversed() const;

  /// The line `right_m(station)` metres to the right of the path from one station to another: a
  /// point at least every metre where it bends, none where it is straight.
  Polyline parallel(double from_m, double to_m, const std::function<double(double)>& right_m) const;
  Polyline parallel(double from_m, double to_m, double right_m) const;

 private:
  struct Place {
    size_t segment;
    double fraction;  ///< below 0 or above 1 beyond the ends
  };
  Place place_at(double station_m) const;
  Eigen::Vector2d position(const Place& place) const;
  Eigen::Vector2d direction(const Place& place) const;

  Polyline points_;
  std::vector<Eigen::Vector2d> directions_;  ///< at the vertices
  std::vector<double> stations_;
};

double length_m(const Polyline& line);

/// The line without those points that lie on a straight between their neighbours.
Polyline without_collinear(const Polyline& line);

/// A smooth curve that leaves p0 along the unit vector d0 and arrives at p1 along d1: a straight
/// and an arc where the two tangents meet ahead, an S otherwise. A point at least every 0.8 m.
Polyline smooth_turn(const Eigen::Vector2d& p0, const Eigen::Vector2d& d0,
                     const Eigen::Vector2d& p1, const Eigen::Vector2d& d1);

/// A smooth road line through waypoints: straights joined by arcs. `tangent_m[i]` is the length of
/// the tangents at waypoint i (its ends are ignored).
Polyline rounded(const Polyline& waypoints, const std::vector<double>& tangent_m);

/// 0 before `begin`, 1 after `end`, smooth between.
double smooth_step(double begin, double end, double value);

/// Appends `tail` to `line`, without a point that they share.
void append(Polyline& line, const Polyline& tail);

Polyline reversed(Polyline line);

}  // namespace bevloc::sim
