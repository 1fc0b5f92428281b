// Compares solutions with the truth, and summarises many of them.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/solver_result.h"
#include "sim/perception/road_kind.h"

namespace bevloc::evaluation {

/// x and y in metres, yaw in degrees.
using PerAxis = std::array<double, 3>;

/// The value of a measure that a method does not provide.
inline constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

/// The errors of one solution. Measures of the distribution are kNotGiven if the method has none.
struct Outcome {
  sim::RoadKind road = sim::RoadKind::kStraightSolid;
  PerAxis error{};           ///< of the correction
  PerAxis parabola_error{};  ///< of SolverResult::parabola
  PerAxis sigma{};           ///< as reported
  PerAxis nll{};             ///< -log of the probability at the truth, interpolated
  double time_ms = 0.0;      ///< processor time of one run with warm caches
};

/// Converts (m, m, rad) to (m, m, degrees).
PerAxis in_units(const Eigen::Vector3d& pose);
PerAxis in_units(const Se2& pose);

Outcome judge(const SolverResult& result, const HypothesisGrid& hypotheses, const Se2& truth);
/// The same, but `sigma` is that of the pose (pose_sigma()): it includes the errors of map and
/// calibration, which no match sees.
Outcome judge_pose(const SolverResult& result, const HypothesisGrid& hypotheses, const Se2& truth);
/// The outcome of a method that reports a correction only.
Outcome judge(const Se2& correction, const Se2& truth);

/// A measure is kNotGiven if it is kNotGiven in any outcome, or if there is no outcome. The
/// coverages leave out the outcomes whose sigma is kNotGiven.
struct Summary {
  size_t scenes = 0;
  PerAxis mae{};
  PerAxis rmse{};
  PerAxis median{};
  PerAxis p95{};
  PerAxis parabola_mae{};
  PerAxis nll{};
  PerAxis coverage_1s{};  ///< share of the errors that are within the reported sigma
  PerAxis coverage_3s{};
  double time_ms = 0.0;  ///< median
};

Summary summarise(const std::vector<Outcome>& outcomes);

}  // namespace bevloc::evaluation
