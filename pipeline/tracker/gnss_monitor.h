// Detects a pose that contradicts GNSS.
#pragma once

#include "pipeline/tracker/tracker.h"

namespace bevloc {

/// A match can stay wrong with high confidence, for example one lane to the side. GNSS is coarse
/// but independent of the match, so a pose that stays far outside the GNSS error is wrong.
///
/// Averages the squared Mahalanobis distance between pose and GNSS over about 1.5 s, so that a
/// single outlier has no effect. Not thread safe.
class GnssMonitor {
 public:
  /// `pose` is the tracked pose at the time of the sample.
  void add(const GnssSample& sample, const TrackedPose& pose);
  void reset() { mean_squared_distance_ = 0.0; }

  /// True while the average exceeds the 99.99 % quantile for a correct pose.
  bool contradicts() const { return mean_squared_distance_ > kLimit; }

 private:
  /// 99.99 % quantile of the chi-square distribution with three degrees of freedom.
  static constexpr double kLimit = 21.1;
  /// Weight of a new sample in the average; suits 10 samples per second.
  static constexpr double kGain = 0.07;

  double mean_squared_distance_ = 0.0;
};

}  // namespace bevloc
