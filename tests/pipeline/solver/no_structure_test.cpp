// A side that holds nothing but noise may not make a confident pose.
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

constexpr int kChannels = 4;

struct LeastDeviation {
  SolverKind kind;
  double of_uniform = 0.5;  ///< 1 sigma of x and y against that of uniform hypotheses
};

class NoStructure : public testing::TestWithParam<LeastDeviation> {
 protected:
  /// The least deviation that is claimed, as a share of that of uniform hypotheses.
  static double least_share(const BevGrid& grid, float amplitude, unsigned seed, bool noisy_map) {
    auto solver = make_solver(GetParam().kind, grid, kChannels, {}, {}).value();
    const auto scene = SyntheticScene::structured(kChannels, 1).seen_from({}, grid);
    std::vector<float> noise(scene.size(), 0.3F);
    add_noise(noise, amplitude, seed);
    SolverResult result;
    solver->solve(view(noisy_map ? scene : noise, kChannels, grid),
                  view(noisy_map ? noise : scene, kChannels, grid), result);
    const Eigen::Vector3d uniform = uniform_variance(HypothesisGrid{}).cwiseSqrt();
    return result.covariance.diagonal().cwiseSqrt().cwiseQuotient(uniform).minCoeff();
  }
};

TEST_P(NoStructure, MakesNoConfidentPose) {
  for (const float amplitude : {1.0F, 0.01F, 0.001F}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      for (const bool noisy_map : {false, true}) {
        EXPECT_GE(least_share(kFeatureGrid, amplitude, seed, noisy_map), GetParam().of_uniform)
            << "noise of " << amplitude << ", seed " << seed << ", noisy map " << noisy_map;
      }
    }
  }
}

TEST_P(NoStructure, MakesNoneOnASmallGridEither) {
  // Some noise does match by chance, and there are few blocks to tell.
  for (const BevGrid& grid : {BevGrid{40, 32, 0.6}, BevGrid{64, 40, 0.6}}) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      EXPECT_GE(least_share(grid, 1.0F, seed, false), 0.5 * GetParam().of_uniform)
          << grid.rows << " rows, seed " << seed;
    }
  }
}

// Axis features, means over a whole row or column, of noise alone correlate by chance more than
// whole grids do: the two that match nothing else claim more.
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
