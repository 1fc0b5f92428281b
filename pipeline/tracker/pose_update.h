// Compares a measured pose with the estimate and updates the estimate.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/tracker/motion_model.h"

namespace bevloc {

struct PoseMeasurement {
  Se2 map_from_vehicle;
  /// In the vehicle frame of the measured pose: (x m, y m, yaw rad).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  /// update() multiplies the covariance by this factor, because consecutive errors are correlated.
  double inflation = 1.0;
};

/// Squared Mahalanobis distance between measurement and estimate, by the sum of their covariances
/// (without the inflation). Chi-square with three degrees of freedom if both covariances are
/// correct.
double squared_distance(const FilterState& state, const PoseMeasurement& measurement);

/// Kalman update in Joseph form, which keeps the covariance symmetric and positive definite.
void update(const PoseMeasurement& measurement, FilterState& state);

}  // namespace bevloc
