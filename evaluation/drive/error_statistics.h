// Statistics of the errors of a series of poses, per axis.
#pragma once

#include <array>
#include <vector>

#include "common/se2.h"
#include "evaluation/quantile.h"

namespace bevloc::evaluation {

/// Absolute errors of one axis, in metres or degrees. All zero for an empty series.
struct AxisError {
  double mae = 0.0;
  double rmse = 0.0;
  double p95 = 0.0;
};

/// The errors of a series of poses.
struct PoseError {
  AxisError longitudinal_m;
  AxisError lateral_m;
  AxisError yaw_deg;
};

/// The error of one pose in the frame of the true vehicle: x longitudinal, y lateral, yaw.
inline Se2 pose_error(const Se2& truth, const Se2& estimate) {
  return correction_between(truth, estimate);
}

/// Collects the errors of poses. One thread.
class ErrorStatistics {
 public:
  void add(const Se2& error);
  PoseError summary() const;

 private:
  std::vector<double> longitudinal_m_;
  std::vector<double> lateral_m_;
  std::vector<double> yaw_deg_;
};

}  // namespace bevloc::evaluation
