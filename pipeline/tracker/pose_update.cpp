#include "pipeline/tracker/pose_update.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace bevloc {
namespace {

/// The measured pose minus the estimate, in the vehicle frame of the estimate.
struct Innovation {
  Eigen::Vector3d error;
  Eigen::Matrix3d covariance;  ///< of the measurement, without that of the estimate
};

Innovation innovation_of(const FilterState& state, const PoseMeasurement& measurement) {
  const Se2 error = correction_between(state.map_from_vehicle, measurement.map_from_vehicle);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(error.yaw_rad).toRotationMatrix();
  return {{error.x_m, error.y_m, error.yaw_rad}, turn * measurement.covariance * turn.transpose()};
}

}  // namespace

double squared_distance(const FilterState& state, const PoseMeasurement& measurement) {
  const Innovation innovation = innovation_of(state, measurement);
  const Eigen::Matrix3d expected = state.covariance.topLeftCorner<3, 3>() + innovation.covariance;
  return innovation.error.dot(expected.ldlt().solve(innovation.error));
}

void update(const PoseMeasurement& measurement, FilterState& state) {
  constexpr int kSize = FilterState::kSize;
  const Innovation innovation = innovation_of(state, measurement);
  const Eigen::Matrix3d noise = measurement.inflation * innovation.covariance;
  const Eigen::Matrix3d expected = state.covariance.topLeftCorner<3, 3>() + noise;
  const Eigen::Matrix<double, kSize, 3> gain =
      expected.ldlt().solve(state.covariance.topRows<3>()).transpose();
  FilterState::Covariance keep = FilterState::Covariance::Identity();
  keep.leftCols<3>() -= gain;
  const FilterState::Covariance updated =
      keep * state.covariance * keep.transpose() + gain * noise * gain.transpose();
  state.covariance = 0.5 * (updated + updated.transpose());
  state.apply(gain * innovation.error);
}

}  // namespace bevloc
