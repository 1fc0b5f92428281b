// Poses and rigid motions in the plane.
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Core>

namespace bevloc {

constexpr double radians(double degrees) {
  return degrees * (std::numbers::pi / 180.0);
}
constexpr double degrees(double radians) {
  return radians * (180.0 / std::numbers::pi);
}

/// Returns the same angle in [-pi, pi].
inline double wrap_angle(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

/// A rigid motion `target_from_source` of the plane: p_target = R(yaw) p_source + (x, y).
/// As a pose it is map_from_vehicle: metres east and north, yaw counter-clockwise from east.
struct Se2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  Eigen::Vector2d operator*(const Eigen::Vector2d& point) const {
    const double c = std::cos(yaw_rad);
    const double s = std::sin(yaw_rad);
    return {c * point.x() - s * point.y() + x_m, s * point.x() + c * point.y() + y_m};
  }

  /// a_from_c = a_from_b * b_from_c.
  Se2 operator*(const Se2& other) const {
    const Eigen::Vector2d position = *this * Eigen::Vector2d(other.x_m, other.y_m);
    return {position.x(), position.y(), wrap_angle(yaw_rad + other.yaw_rad)};
  }

  Se2 inverse() const {
    const double c = std::cos(yaw_rad);
    const double s = std::sin(yaw_rad);
    return {-c * x_m - s * y_m, s * x_m - c * y_m, wrap_angle(-yaw_rad)};
  }

  Eigen::Vector2d translation() const { return {x_m, y_m}; }

  bool is_finite() const {
    return std::isfinite(x_m) && std::isfinite(y_m) && std::isfinite(yaw_rad);
  }
};

/// Motion of a vehicle during `duration_s` at constant speed and yaw rate: start_from_end. Its
/// translation is the chord of the arc, accurate to second order in the angle turned.
inline Se2 arc_motion(double speed_mps, double yaw_rate_radps, double duration_s) {
  const double distance_m = speed_mps * duration_s;
  const double turn_rad = yaw_rate_radps * duration_s;
  return {distance_m * std::cos(0.5 * turn_rad), distance_m * std::sin(0.5 * turn_rad), turn_rad};
}

/// The correction dT between two poses (paper, eq. 1): dT = from^-1 * to, so to = from * dT.
/// x is longitudinal and y is lateral in the frame of `from`.
inline Se2 correction_between(const Se2& from, const Se2& to) {
  return from.inverse() * to;
}

}  // namespace bevloc
