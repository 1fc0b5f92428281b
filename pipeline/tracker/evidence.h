// Decides what a match confirms: only what was really seen counts.
#pragma once

#include "pipeline/solver/solver_result.h"

namespace bevloc {

/// These limits decide what counts as seen. They fit every network, because its file has a factor
/// on its scores (SolverParameters::score_scale).
struct EvidenceLimits {
  /// Largest probability near the border of the search range. If it is larger, the truth may lie
  /// outside, and the answer on this axis is worth nothing.
  double max_edge_mass = 0.25;
  /// The match must have removed this share of the variance of the search range.
  double min_share = 0.5;
  /// A second peak this high means two places that look alike.
  double max_rival_peak = 0.7;
  /// Mean score of the recent matches that confirms the place.
  double min_score = 0.18;
  /// If the score of an axis is below this, its answer often belongs to another place along the
  /// axis. Its standard deviation is then multiplied by good_axis_score / score, at most by
  /// max_growth.
  double good_axis_score = 0.12;
  double max_growth = 4.0;
};

/// What one match confirms.
struct Seen {
  bool across = false;
  bool heading = false;
  bool unique = false;  ///< no other place in the search range looks alike across the road
  bool place = false;   ///< perceived and mapped lines lie on each other (mean score)
  /// Axes on which the best place is at the border of the search range: the truth may lie outside.
  Eigen::Array<bool, 3, 1> at_border{false, false, false};

  /// Whether the match confirms a pose that is already trusted. Often nothing shows the place along
  /// the road or the heading for seconds. Dead reckoning then carries the pose, and its sigma
  /// grows.
  bool confirms() const { return across && place; }
  /// Whether the match supports a new pose (StartConfirmation).
  bool confirms_start() const { return confirms() && heading && unique; }
};

/// Keeps the mean score of the recent matches. Allocates nothing. One thread.
class EvidenceMonitor {
 public:
  explicit EvidenceMonitor(const EvidenceLimits& limits = {}) : limits_(limits) {}

  /// Judges a match, and widens each axis of `match` that has a low score.
  Seen judge(MatchResult& match);

  /// The factor by which the standard deviation of an axis grows because of its score.
  double growth_of(double axis_score) const;

  double mean_score() const { return mean_score_; }
  void reset() { mean_score_ = 0.0; }

 private:
  EvidenceLimits limits_;
  double mean_score_ = 0.0;
};

/// Removes the evidence of the axes of `match` on which the best place is at the border.
void forget_border(const Seen& seen, MatchResult& match);

}  // namespace bevloc
