// How a vehicle moves between odometry samples, and how wrong that may be.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"

namespace bevloc {

/// Wheel odometry as it is measured, before it is corrected.
struct MeasuredMotion {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// What the filter estimates.
struct FilterState {
  enum Index { kX, kY, kYaw, kSpeedScale, kYawRateBias, kSize };
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, 1>;

  Se2 map_from_vehicle;
  double speed_scale_error = 0.0;    ///< true speed = (1 + error) * measured speed
  double yaw_rate_bias_radps = 0.0;  ///< true yaw rate = measured yaw rate - bias
  /// Of the error in the vehicle's own frame: true pose = pose * (x m, y m, yaw rad), then scale
  /// and bias. Symmetric positive definite.
  Covariance covariance = Covariance::Identity();

  double speed_mps(const MeasuredMotion& motion) const {
    return (1.0 + speed_scale_error) * motion.speed_mps;
  }
  double yaw_rate_radps(const MeasuredMotion& motion) const {
    return motion.yaw_rate_radps - yaw_rate_bias_radps;
  }

  /// Moves the estimate by an error as `covariance` counts it.
  void apply(const Vector& error);
};

/// Random parts of the motion, as standard deviations. White ones grow with the square root of the
/// distance or time that follows "per sqrt".
struct MotionNoise {
  double longitudinal_m_per_sqrt_m = 0.02;       ///< wheel speed: 0.2 m after 100 m
  double lateral_m_per_sqrt_m = 0.01;            ///< side slip
  double yaw_rad_per_sqrt_s = radians(0.1);      ///< yaw rate noise
  double speed_scale_per_sqrt_s = 2e-4;          ///< tyres warm up, pressure changes
  double yaw_rate_bias_radps_per_sqrt_s = 5e-5;  ///< drift of the sensor
  /// What the vehicle may do between two samples: counts only where samples are missing.
  double acceleration_mps2 = 3.0;
  double yaw_acceleration_radps2 = 0.5;
};

/// Moves the state on by `duration_s` >= 0 at a steady `motion`.
void predict(const MeasuredMotion& motion, double duration_s, const MotionNoise& noise,
             FilterState& state);

}  // namespace bevloc
