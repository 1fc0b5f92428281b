// The state of the tracker's filter, and its prediction between odometry samples.
#pragma once

#include <cmath>

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

/// The noise of standing wheels stays below this speed.
inline constexpr double kStandingSpeed_mps = 0.1;
/// The bias of a yaw rate sensor stays within this rate of its estimate.
inline constexpr double kStandingYawRate_radps = radians(0.5);
/// In a longer step without odometry, a vehicle that stands at both ends may have moved and turned.
inline constexpr double kLongestStandstillStep_s = 0.5;

/// The state that the filter estimates, with its covariance.
///
/// Consecutive errors of matches are alike, because the same network sees the same part of the map
/// again; those of GNSS, because multipath and atmosphere change slowly. The correlated part of
/// each is therefore a state: otherwise the filter would average it out as if it were noise. Both
/// are normalised: 1 is one standard deviation of the measurement's own correlated error.
struct FilterState {
  enum Index {
    kX,
    kY,
    kYaw,
    kSpeedScale,
    kYawRateBias,
    kMatchError,                   ///< three: x, y, yaw in the vehicle frame
    kGnssError = kMatchError + 3,  ///< three: east, north, yaw in the map frame
    kSize = kGnssError + 3,
  };
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, 1>;

  Se2 map_from_vehicle;
  double speed_scale_error = 0.0;    ///< true speed = (1 + error) * measured speed
  double yaw_rate_bias_radps = 0.0;  ///< true yaw rate = measured yaw rate - bias
  Eigen::Vector3d match_error = Eigen::Vector3d::Zero();
  Eigen::Vector3d gnss_error = Eigen::Vector3d::Zero();
  /// Covariance of the error in the order of Index (m, m, rad, 1, rad/s, then normalised). The pose
  /// error is in the vehicle frame: true pose = map_from_vehicle * error. Symmetric positive
  /// definite.
  Covariance covariance = Covariance::Identity();

  double speed_mps(const MeasuredMotion& motion) const {
    return (1.0 + speed_scale_error) * motion.speed_mps;
  }
  double yaw_rate_radps(const MeasuredMotion& motion) const {
    return stands(motion) ? 0.0 : motion.yaw_rate_radps - yaw_rate_bias_radps;
  }
  /// Whether the vehicle stands. It does not turn then, so its heading does not change.
  bool stands(const MeasuredMotion& motion) const {
    return std::abs(motion.speed_mps) < kStandingSpeed_mps &&
           std::abs(motion.yaw_rate_radps - yaw_rate_bias_radps) < kStandingYawRate_radps;
  }

  /// Adds an estimated error, in the order of Index, to the estimate.
  void apply(const Vector& error);

  /// Adds an independent error of this standard deviation to the uncertainty of one state.
  void add_sigma(Index index, double sigma) { covariance(index, index) += square_of(sigma); }
};

/// Process noise as standard deviations. The word "per_sqrt" marks white noise, whose sigma grows
/// with the square root of the distance or time.
struct MotionNoise {
  double longitudinal_m_per_sqrt_m = 0.02;    ///< wheel speed noise: 0.2 m after 100 m
  double lateral_m_per_sqrt_m = 0.01;         ///< side slip
  double yaw_rad_per_sqrt_s = radians(0.02);  ///< yaw rate noise
  /// The scale changes with the temperature and pressure of the tyres. The filter must also follow
  /// a scale that is suddenly wrong by 2 %.
  double speed_scale_per_sqrt_s = 4e-4;
  /// Drift of the yaw rate sensor's bias. Tracker::loosen_odometry() covers a faster change.
  double yaw_rate_bias_radps_per_sqrt_s = 1e-4;
  /// Unmeasured accelerations between two samples; they matter only where samples are missing.
  double acceleration_mps2 = 3.0;
  double yaw_acceleration_radps2 = 0.5;

  bool operator==(const MotionNoise&) const = default;
};

/// How long the correlated errors last: they decay by a factor of e over this distance or time.
/// With 0 the errors are independent. The distances were measured on simulated drives with the
/// shipped network. In these drives about half of the variance of a match was correlated. This part
/// fell to about a third within 5 m (along), 10 m (across) and 8 m (heading). For the heading,
/// match_m has more, 10 m: the filter then learns less from many matches. A sixth of the variance
/// across the vehicle stayed correlated over more than 40 m; MeasurementModel::constant_error
/// covers it.
struct ErrorCorrelation {
  Eigen::Vector3d match_m{5.0, 10.0, 10.0};  ///< along, across, heading
  double gnss_s = 40.0;

  bool operator==(const ErrorCorrelation&) const = default;
};

/// Returns the share of a correlated error that is left after a distance or time of `amount`. The
/// error decays by a factor of e over `correlation`, the distance or time of ErrorCorrelation. With
/// a correlation of 0, the share is 0.
inline double kept_share(double amount, double correlation) {
  return correlation > 0.0 ? std::exp(-amount / correlation) : 0.0;
}

/// Predicts `state` forward by `duration_s` >= 0 with constant `motion`. A standing vehicle keeps
/// its match error, so standing still adds no knowledge. It also keeps its heading and the sigma of
/// the heading, except in a step longer than kLongestStandstillStep_s.
void predict(const MeasuredMotion& motion, double duration_s, const MotionNoise& noise,
             const ErrorCorrelation& correlation, FilterState& state);

}  // namespace bevloc
