// Raises the variance of uncertain matches and of those that repeat what earlier matches said.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "common/time.h"
#include "pipeline/tracker/motion_model.h"
#include "pipeline/tracker/pose_update.h"

namespace bevloc {

/// The filter has a state for the error that consecutive matches share (FilterState::match_error).
/// This class raises the variance of matches for what that state does not cover:
/// - An uncertain match has a larger error than its sigma says. Uncertain matches near each other
///   have similar errors.
/// - Matches a few centimetres apart see nearly the same picture, so that even their noise is
///   alike. A slow vehicle makes many of them.
/// - All matches of a standing vehicle see the same picture, so the k-th of them counts with
///   1 + (k - 1)^2 times its noise. All of them say little more than the first.
///
/// Allocates nothing. One thread.
class MatchRepetition {
 public:
  /// Sets the `repeated_variance` of a match that the filter is about to use, and remembers it.
  /// `stands` says whether the vehicle stands (FilterState::stands).
  void discount(Time time, double speed_mps, bool stands, const ErrorCorrelation& correlation,
                PoseMeasurement& match);

  /// Makes the next match repeat nothing, because the pose is new or its covariance was raised, or
  /// because odometry was missing.
  void forget() { *this = {}; }

 private:
  /// How many times its own noise is added to a match that is `distance_m` from the latest one.
  /// Counts the matches of a standing vehicle.
  double repeats_of_noise(double distance_m, bool stands);

  int standing_matches_ = 0;    ///< number since the vehicle stands
  std::optional<Time> latest_;  ///< time of the latest match that the filter has used
};

}  // namespace bevloc
