// What a solver returns: the correction, its covariance and the distributions of the hypotheses.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "common/se2.h"

namespace bevloc {

/// Whether a result may be used.
enum class Evidence {
  kGood,  ///< use it
  kNone,  ///< nothing to match: one side is empty, constant or not finite
};

/// The correction of one match, with its uncertainty.
struct MatchResult {
  Evidence evidence = Evidence::kNone;
  Se2 correction;  ///< dT = T0^-1 T; zero without evidence
  /// Covariance of the correction in T0's frame: (x m, y m, yaw rad). It includes the prior that
  /// all hypotheses are equally likely.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Per axis (x, y, yaw): the share of the hypotheses' variance that the match removed. At 0 or
  /// less the match says nothing about the axis; near 1 it is as exact as the steps allow.
  Eigen::Vector3d evidence_share = Eigen::Vector3d::Ones();
  /// How well the perceived features lie on the mapped ones at the correction: their overlap
  /// (match_score.h) times SolverParameters::score_scale, 0 for none. Unlike the distributions it
  /// is absolute: it tells a match of the right place from the best match of a wrong one.
  double score = 0.0;
  /// Per axis (x, y, yaw): the overlap of the structure that shows a movement along the axis, at
  /// most 1.
  Eigen::Vector3d axis_score = Eigen::Vector3d::Zero();
  /// Per axis: the probability of the hypotheses at the border of the search range or one step away
  /// from it. If it is large, the true correction may lie outside the range.
  Eigen::Vector3d edge_mass = Eigen::Vector3d::Zero();
  /// Per axis: the second highest peak of the distribution divided by the highest. It is 0 for a
  /// single peak and 1 for two equally likely peaks.
  Eigen::Vector3d rival_peak = Eigen::Vector3d::Zero();
};

/// A MatchResult with the distributions that it was computed from. `correction` is their means,
/// except for the literal solvers without refinement (reference/literal_matcher.h).
struct SolverResult : MatchResult {
  /// An alternative estimate. Per axis, it is the vertex of the parabola through the logarithms of
  /// the most likely hypothesis and its two neighbours. It is zero without evidence.
  Se2 parabola;
  /// Probability of each hypothesis of the axis; each distribution sums to 1.
  std::vector<float> x_probability;
  std::vector<float> y_probability;
  std::vector<float> yaw_probability;
};

}  // namespace bevloc
