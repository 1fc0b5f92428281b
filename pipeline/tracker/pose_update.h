// A measured pose against the estimated one.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/tracker/motion_model.h"

namespace bevloc {

struct PoseMeasurement {
  Se2 map_from_vehicle;
  /// Of the measurement alone, in the measured vehicle's frame: (x m, y m, yaw rad).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  /// How many times the covariance counts in the filter, because consecutive errors are alike.
  double inflation = 1.0;
};

/// Squared Mahalanobis distance between measurement and estimate, both with their covariances: chi
/// square with three degrees of freedom where both are honest.
double squared_distance(const FilterState& state, const PoseMeasurement& measurement);

/// Kalman update in Joseph's form: the covariance stays symmetric and positive definite.
void update(const PoseMeasurement& measurement, FilterState& state);

}  // namespace bevloc
