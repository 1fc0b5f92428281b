// Motion model of the tracker: predicts pose and covariance between odometry samples.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"

namespace bevloc {

inline double square_of(double value) {
  return value * value;
}

/// Odometry as measured, without the estimated corrections.
struct MeasuredMotion {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// The state that the filter estimates, with its covariance.
struct FilterState {
  enum Index { kX, kY, kYaw, kSpeedScale, kYawRateBias, kSize };
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, 1>;

  Se2 map_from_vehicle;
  double speed_scale_error = 0.0;    ///< true speed = (1 + error) * measured speed
  double yaw_rate_bias_radps = 0.0;  ///< true yaw rate = measured yaw rate - bias
  /// Of the error (x m, y m, yaw rad, scale, bias rad/s) in the order of Index. The pose error is
  /// in the vehicle frame: true pose = map_from_vehicle * error. Symmetric positive definite.
  Covariance covariance = Covariance::Identity();

  double speed_mps(const MeasuredMotion& motion) const {
    return (1.0 + speed_scale_error) * motion.speed_mps;
  }
  double yaw_rate_radps(const MeasuredMotion& motion) const {
    return motion.yaw_rate_radps - yaw_rate_bias_radps;
  }

  /// Adds an estimated error, in the order of Index, to the estimate.
  void apply(const Vector& error);
};

/// Process noise as standard deviations. "per_sqrt": white noise, whose sigma grows with the square
/// root of the distance or time.
struct MotionNoise {
  double longitudinal_m_per_sqrt_m = 0.02;       ///< wheel speed noise: 0.2 m after 100 m
  double lateral_m_per_sqrt_m = 0.01;            ///< side slip
  double yaw_rad_per_sqrt_s = radians(0.1);      ///< yaw rate noise
  double speed_scale_per_sqrt_s = 2e-4;          ///< change of tyre temperature and pressure
  double yaw_rate_bias_radps_per_sqrt_s = 5e-5;  ///< drift of the sensor bias
  /// Unmeasured accelerations between two samples; they matter only where samples are missing.
  double acceleration_mps2 = 3.0;
  double yaw_acceleration_radps2 = 0.5;

  bool operator==(const MotionNoise&) const = default;
};

/// Predicts `state` forward by `duration_s` >= 0 with constant `motion`.
void predict(const MeasuredMotion& motion, double duration_s, const MotionNoise& noise,
             FilterState& state);

}  // namespace bevloc
