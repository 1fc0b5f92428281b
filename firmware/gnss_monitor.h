// Notices when the pose has wandered off from what GNSS says.
#pragma once

#include "pipeline/tracker/tracker.h"

namespace bevloc::firmware {

/// A match can be wrong and stay wrong with confidence: the next lane looks alike. GNSS is coarse
/// but does not follow the match, so a pose that stays far outside its error is not to be believed.
/// Watches the squared, normalised distance of pose and GNSS, averaged over about a second and a
/// half: one bad reading says nothing. One thread.
class GnssMonitor {
 public:
  void add(const GnssSample& sample, const TrackedPose& pose);
  void reset() { mean_squared_distance_ = 0.0; }

  /// Beyond what 99.99 % of honest poses reach.
  bool contradicts() const { return mean_squared_distance_ > kLimit; }

 private:
  /// Chi square of three degrees of freedom.
  static constexpr double kLimit = 21.1;
  /// Weight of a new reading, at ten a second.
  static constexpr double kGain = 0.07;

  double mean_squared_distance_ = 0.0;
};

}  // namespace bevloc::firmware
