// How good the solutions of many scenes are.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "pipeline/solver/solver.h"
#include "sim/perception/road_kind.h"

namespace bevloc::evaluation {

/// x and y in metres, yaw in degrees.
using PerAxis = std::array<double, 3>;

/// What a method says nothing about.
inline constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

/// One solution, judged. kNotGiven where the method has no distribution.
struct Outcome {
  sim::RoadKind road = sim::RoadKind::kStraightSolid;
  PerAxis error{};           ///< of the correction
  PerAxis parabola_error{};  ///< of the parabola's estimate
  PerAxis sigma{};           ///< that the solver claimed
  PerAxis nll{};             ///< -log of the probability at the truth, read between hypotheses
  double time_ms = 0.0;      ///< of one thread of the processor, caches warm
};

Outcome judge(const SolverResult& result, const HypothesisGrid& hypotheses, const Se2& truth);
/// A correction without a distribution.
Outcome judge(const Se2& correction, const Se2& truth);

/// kNotGiven where an outcome is.
struct Summary {
  size_t scenes = 0;
  PerAxis mae{};
  PerAxis rmse{};
  PerAxis median{};
  PerAxis p95{};
  PerAxis parabola_mae{};
  PerAxis nll{};
  PerAxis coverage_1s{};  ///< share of errors within the claimed sigma
  PerAxis coverage_3s{};
  double time_ms = 0.0;  ///< median
};

Summary summarise(const std::vector<Outcome>& outcomes);

/// -log of uniform probability over each axis: what knowing nothing costs.
PerAxis uniform_nll(const HypothesisGrid& hypotheses);

}  // namespace bevloc::evaluation
