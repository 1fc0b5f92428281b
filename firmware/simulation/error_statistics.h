// How far a series of poses was from the truth, axis by axis.
#pragma once

#include <array>
#include <vector>

#include "common/se2.h"

namespace bevloc::firmware {

/// Of one axis, absolute errors: metres, or degrees for yaw. All zero for an empty series.
struct AxisError {
  double mae = 0.0;
  double rmse = 0.0;
  double p95 = 0.0;
};

struct PoseError {
  AxisError longitudinal_m;
  AxisError lateral_m;
  AxisError yaw_deg;
};

/// The error of one pose, seen from the true vehicle: x longitudinal, y lateral, yaw.
inline Se2 pose_error(const Se2& truth, const Se2& estimate) {
  return correction_between(truth, estimate);
}

class ErrorStatistics {
 public:
  void add(const Se2& error);
  PoseError summary() const;

 private:
  std::vector<double> longitudinal_m_;
  std::vector<double> lateral_m_;
  std::vector<double> yaw_deg_;
};

/// The value that a share `quantile` of the values does not exceed (nearest rank); 0 for none.
double quantile_of(std::vector<double> values, double quantile);

}  // namespace bevloc::firmware
