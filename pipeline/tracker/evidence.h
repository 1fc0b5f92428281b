// Decides what a match confirms: only what was really seen counts.
#pragma once

#include "pipeline/solver/solver_result.h"

namespace bevloc {

/// What one match confirms.
struct Seen {
  bool across = false;
  bool heading = false;
  bool unique = false;  ///< across the road, no other place in the range looks like this one
  bool place = false;   ///< perceived and mapped lines lie on each other
  /// Axes on which the best place is at the border of the search range: the truth may lie outside.
  Eigen::Array<bool, 3, 1> at_border{false, false, false};

  /// Whether the match confirms a pose that is already trusted. Often nothing shows the place along
  /// the road or the heading for seconds. Dead reckoning then carries the pose, and its sigma
  /// grows.
  bool confirms() const { return across && place; }
  /// Whether the match supports a new pose (StartConfirmation).
  bool confirms_start() const { return confirms() && heading && unique; }
};

/// Keeps the mean score of the recent matches. Its limits fit every network, because the file of
/// a network has a factor on its scores (SolverParameters::score_scale). Allocates nothing. One
/// thread.
class EvidenceMonitor {
 public:
  /// The mean score of the recent matches that confirms the place.
  static constexpr double kMinScore = 0.18;
  /// The largest growth_of() a score.
  static constexpr double kMaxGrowth = 4.0;

  /// Judges a match, and widens each axis of `match` that has a low score. The mean score confirms
  /// the place.
  Seen judge(MatchResult& match);

  /// Does the same for a match without earlier ones: its own score confirms the place.
  static Seen judge_alone(MatchResult& match);

  /// The factor by which the standard deviation of an axis grows because of its score.
  static double growth_of(double axis_score);

  void reset() { mean_score_ = 0.0; }

 private:
  double mean_score_ = 0.0;
};

/// Removes the evidence of the axes of `match` on which the best place is at the border.
void forget_border(const Seen& seen, MatchResult& match);

}  // namespace bevloc
