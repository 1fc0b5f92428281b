// Decides when matches and GNSS together confirm a new pose.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "common/vehicle_samples.h"

namespace bevloc {

/// A match of a pose that is not trusted yet.
struct StartMatch {
  double score = 0.0;         ///< score of the whole match
  double along_score = 0.0;   ///< score along the road
  double along_growth = 1.0;  ///< EvidenceMonitor::growth_of() that score
  bool sees = false;          ///< Seen::confirms_start()
};

/// One lane looks like the next for a while: a match beside the right lane has a good score across
/// the road, and a low one along it, because crossings and line ends do not fit. The support that
/// matches give therefore adds up, as in a sequential test (Wald, "Sequential Tests of Statistical
/// Hypotheses", 1945), until it outweighs the distance between the pose and GNSS.
///
/// Allocates nothing. One thread.
class StartConfirmation {
 public:
  /// GNSS with a smaller sigma tells lanes apart by itself, so its errors count in units of this
  /// value.
  static constexpr double kLeastGnssSigma_m = 1.0;

  /// A standing vehicle sees the same in every match, so only the first ones count.
  void add(const OdometrySample& odometry);

  /// Adds a match that the tracker has not refused. A low score takes support away.
  void add(const StartMatch& match);

  /// Forgets what was seen, because a match was refused or the pose begins again.
  void reset();

  /// Whether the support suffices. `gnss_error` is GnssError::in_vehicle(). `gnss_sigma_m` is the
  /// standard deviation of the position.
  bool confirms(const Eigen::Vector3d& gnss_error, double gnss_sigma_m) const;

 private:
  static constexpr double kMostMatches = 20.0;

  double support_ = 0.0;
  double countable_ = kMostMatches;  ///< matches that may still count before the vehicle drives on
  std::optional<Time> odometry_time_;
};

}  // namespace bevloc
