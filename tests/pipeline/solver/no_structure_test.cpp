// If one side is pure noise, no solver may claim a small covariance.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/solver_name.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

constexpr int kFewChannels = 4;

struct LeastDeviation {
  SolverKind kind;
  double share = 0.5;  ///< the least allowed sigma, divided by that of uniform hypotheses
};

class NoStructure : public testing::TestWithParam<LeastDeviation> {
 protected:
  /// The smallest claimed sigma of all axes, divided by that of uniform hypotheses.
  static double least_share(const BevGrid& grid, float amplitude, unsigned seed, bool noisy_map) {
    auto solver = make_solver(GetParam().kind, grid, kFewChannels, {}, {}).value();
    const auto scene = SyntheticScene::structured(kFewChannels, 1).seen_from({}, grid);
    std::vector<float> noise(scene.size(), 0.3F);
    add_noise(noise, amplitude, seed);
    SolverResult result;
    solver->solve(view(noisy_map ? scene : noise, kFewChannels, grid),
                  view(noisy_map ? noise : scene, kFewChannels, grid), result);
    const Eigen::Vector3d uniform = uniform_variance(HypothesisGrid{}).cwiseSqrt();
    return result.covariance.diagonal().cwiseSqrt().cwiseQuotient(uniform).minCoeff();
  }
};

TEST_P(NoStructure, ClaimsALargeCovariance) {
  for (const float amplitude : {1.0F, 0.01F, 0.001F}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      for (const bool noisy_map : {false, true}) {
        EXPECT_GE(least_share(kFeatureGrid, amplitude, seed, noisy_map), GetParam().share)
            << "noise of " << amplitude << ", seed " << seed << ", noisy map " << noisy_map;
      }
    }
  }
}

TEST_P(NoStructure, ClaimsALargeCovarianceOnASmallGrid) {
  // Some noise matches by chance, and a small grid has few blocks to detect that.
  for (const BevGrid& grid : {BevGrid{40, 32, 0.6}, BevGrid{64, 40, 0.6}}) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      EXPECT_GE(least_share(grid, 1.0F, seed, false), 0.5 * GetParam().share)
          << grid.rows << " rows, seed " << seed;
    }
  }
}

// Axis features are means over a whole row or column. Those of pure noise correlate more by chance
// than whole grids do, so the two solvers that match axis features alone claim smaller sigmas.
INSTANTIATE_TEST_SUITE_P(
    Solvers, NoStructure,
    testing::Values(LeastDeviation{SolverKind::kFull}, LeastDeviation{SolverKind::kFullFft},
                    LeastDeviation{SolverKind::kDecoupledLiteral, 0.2},
                    LeastDeviation{SolverKind::kDecoupledLiteralRefined},
                    LeastDeviation{SolverKind::kDecoupled, 0.3},
                    LeastDeviation{SolverKind::kDecoupledRefined},
                    LeastDeviation{SolverKind::kBanded}, LeastDeviation{SolverKind::kBandedRefined},
                    LeastDeviation{SolverKind::kBlock}, LeastDeviation{SolverKind::kBlockRefined}),
    kSolverName);

}  // namespace
}  // namespace bevloc
