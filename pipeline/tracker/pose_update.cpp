#include "pipeline/tracker/pose_update.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace bevloc {
namespace {

using Jacobian = Eigen::Matrix<double, 3, FilterState::kSize>;

Eigen::Matrix3d turn_by(double yaw_rad) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(yaw_rad).toRotationMatrix();
  return turn;
}

/// A measurement, linearised around an estimate.
struct Linearised {
  Eigen::Vector3d error;  ///< measured pose minus expected pose, in the estimate's vehicle frame
  Jacobian jacobian;
  Eigen::Matrix3d noise;
};

Linearised linearise(const FilterState& state, const PoseMeasurement& measurement) {
  const Se2 difference = correction_between(state.map_from_vehicle, measurement.map_from_vehicle);
  const bool is_match = measurement.source == PoseSource::kMatch;
  const int correlated = is_match ? FilterState::kMatchError : FilterState::kGnssError;
  // Turns errors from the axes of the measurement into the vehicle frame of the estimate.
  const Eigen::Matrix3d axes = turn_by(measurement.axes_yaw_rad - state.map_from_vehicle.yaw_rad);
  const Eigen::Matrix3d scale = axes * measurement.correlated_sigma.asDiagonal();

  Linearised result;
  result.jacobian.setZero();
  result.jacobian.leftCols<3>().setIdentity();
  result.jacobian.middleCols<3>(correlated) = scale;
  result.error = Eigen::Vector3d(difference.x_m, difference.y_m, difference.yaw_rad) -
                 scale * (is_match ? state.match_error : state.gnss_error);
  result.noise = axes * measurement.covariance * axes.transpose();
  return result;
}

Eigen::Matrix3d expected_covariance(const FilterState& state, const Linearised& linearised) {
  return linearised.jacobian * state.covariance * linearised.jacobian.transpose() +
         linearised.noise;
}

}  // namespace

Eigen::Vector3d GnssError::in_vehicle() const {
  return turn_by(-vehicle_yaw_rad) * in_map;
}

double squared_distance(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

PoseInnovation innovation_of(const FilterState& state, const PoseMeasurement& measurement) {
  const Linearised linearised = linearise(state, measurement);
  PoseInnovation innovation;
  innovation.error = linearised.error;
  innovation.covariance = expected_covariance(state, linearised);
  innovation.squared_distance = squared_distance(innovation.error, innovation.covariance);
  innovation.unexplained = innovation.squared_distance;
  return innovation;
}

FilterState state_from(const PoseMeasurement& measurement, double speed_scale_variance,
                       double yaw_rate_bias_variance) {
  using S = FilterState;
  FilterState state;
  state.map_from_vehicle = measurement.map_from_vehicle;
  // The error of the pose is that of the measurement: noise and correlated part.
  const Linearised linearised = linearise(state, measurement);
  const bool is_match = measurement.source == PoseSource::kMatch;
  const int correlated = is_match ? S::kMatchError : S::kGnssError;
  const Eigen::Matrix3d scale = linearised.jacobian.middleCols<3>(correlated);
  state.covariance.topLeftCorner<3, 3>() = linearised.noise + scale * scale.transpose();
  state.covariance.block<3, 3>(0, correlated) = -scale;
  state.covariance.block<3, 3>(correlated, 0) = -scale.transpose();
  state.covariance(S::kSpeedScale, S::kSpeedScale) = speed_scale_variance;
  state.covariance(S::kYawRateBias, S::kYawRateBias) = yaw_rate_bias_variance;
  return state;
}

void renew_match_error(FilterState& state) {
  constexpr int kError = FilterState::kMatchError;
  state.match_error.setZero();
  state.covariance.middleRows<3>(kError).setZero();
  state.covariance.middleCols<3>(kError).setZero();
  state.covariance.block<3, 3>(kError, kError).setIdentity();
}

void update(const PoseMeasurement& measurement, FilterState& state) {
  if (measurement.has_new_error) renew_match_error(state);
  PoseMeasurement repeated = measurement;
  repeated.covariance.diagonal() += measurement.repeated_variance;
  const Linearised linearised = linearise(state, repeated);
  const Jacobian& h = linearised.jacobian;
  const Eigen::Matrix<double, FilterState::kSize, 3> gain =
      expected_covariance(state, linearised).ldlt().solve(h * state.covariance).transpose();
  const FilterState::Covariance keep = FilterState::Covariance::Identity() - gain * h;
  const FilterState::Covariance updated =
      keep * state.covariance * keep.transpose() + gain * linearised.noise * gain.transpose();
  state.covariance = 0.5 * (updated + updated.transpose());
  state.apply(gain * linearised.error);
}

}  // namespace bevloc
