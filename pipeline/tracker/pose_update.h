// Compares a measured pose with the estimate and updates the estimate.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/tracker/motion_model.h"

namespace bevloc {

enum class PoseSource : uint8_t { kMatch, kGnss };

/// A measured pose. Its error is independent noise plus a part that is correlated over time.
struct PoseMeasurement {
  PoseSource source = PoseSource::kMatch;
  Se2 map_from_vehicle;
  /// Direction of the x axis of all errors below, in the map frame. It is 0 for GNSS. For a match
  /// it is the yaw of the prior, because the solver searches along and across the prior.
  double axes_yaw_rad = 0.0;
  /// Covariance of the independent noise: (x m, y m, yaw rad).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  /// Standard deviations of the correlated part.
  Eigen::Vector3d correlated_sigma = Eigen::Vector3d::Zero();
  /// Part of the diagonal of `covariance`: the correlated variance beyond
  /// MeasurementModel::match_common_sigma, which only uncertain matches have.
  Eigen::Vector3d uncommon_variance = Eigen::Vector3d::Zero();
  /// Variance that update() adds to the noise of a match (MatchRepetition). The gate does not add
  /// it.
  Eigen::Vector3d repeated_variance = Eigen::Vector3d::Zero();
  /// Whether the correlated error is independent of that of the measurements before. update() then
  /// calls renew_match_error().
  bool has_new_error = false;
};

/// The difference between a measured pose and the estimate, in the vehicle frame of the estimate:
/// (x m, y m, yaw rad).
struct PoseInnovation {
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  /// Expected covariance of `error`: the sum of the covariances of the estimate, the noise and
  /// the correlated part.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  /// Squared Mahalanobis distance. It has a chi-square distribution with three degrees of freedom
  /// if the covariances are correct.
  double squared_distance = 0.0;
  /// Whether it comes from a match of a standing vehicle, which only repeats the match before.
  bool repeats = false;
  /// Squared distance after renew_match_error(), but at most `squared_distance`. For GNSS it equals
  /// `squared_distance`.
  double unexplained = 0.0;
};

/// The filter's estimate of the correlated error of GNSS, in its standard deviations.
struct GnssError {
  Eigen::Vector3d in_map = Eigen::Vector3d::Zero();  ///< (east, north, yaw)
  double vehicle_yaw_rad = 0.0;                      ///< heading of the vehicle in the map

  /// (along, across, yaw) of the vehicle.
  Eigen::Vector3d in_vehicle() const;
};

/// Squared Mahalanobis distance.
double squared_distance(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance);

PoseInnovation innovation_of(const FilterState& state, const PoseMeasurement& measurement);

/// Returns the state that knows nothing but `measurement`, with the given variances of the odometry
/// errors.
FilterState state_from(const PoseMeasurement& measurement, double speed_scale_variance,
                       double yaw_rate_bias_variance);

/// Forgets what is known about the match error. Call it when the next match has another error. The
/// pose and its uncertainty stay as they are.
void renew_match_error(FilterState& state);

/// Kalman update in Joseph form, which keeps the covariance symmetric and positive definite.
void update(const PoseMeasurement& measurement, FilterState& state);

}  // namespace bevloc
