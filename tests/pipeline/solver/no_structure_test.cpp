// A side that holds nothing but noise may not make a confident pose.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

constexpr int kChannels = 4;

struct LeastDeviation {
  SolverKind kind;
  double of_uniform = 0.5;  ///< 1 sigma of x and y against that of uniform hypotheses
};

class NoStructure : public testing::TestWithParam<LeastDeviation> {};

TEST_P(NoStructure, MakesNoConfidentPose) {
  auto solver = make_solver(GetParam().kind, kFeatureGrid, kChannels, {}, {}).value();
  const auto scene = SyntheticScene::structured(kChannels, 1).seen_from({}, kFeatureGrid);
  const Eigen::Vector3d uniform = uniform_variance(HypothesisGrid{}).cwiseSqrt();
  SolverResult result;
  for (const float amplitude : {1.0F, 0.01F, 0.001F}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      std::vector<float> noise(scene.size(), 0.3F);
      add_noise(noise, amplitude, seed);
      for (const bool noisy_map : {false, true}) {
        solver->solve(view(noisy_map ? scene : noise, kChannels, kFeatureGrid),
                      view(noisy_map ? noise : scene, kChannels, kFeatureGrid), result);
        const Eigen::Vector3d share =
            result.covariance.diagonal().cwiseSqrt().cwiseQuotient(uniform);
        EXPECT_GE(share.minCoeff(), GetParam().of_uniform)
            << "noise of " << amplitude << ", seed " << seed << ", noisy map " << noisy_map;
      }
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
    [](const auto& test) {
      std::string name(name_of(test.param.kind));
      std::ranges::replace_if(
          name, [](char c) { return c == '-' || c == '+'; }, '_');
      return name;
    });

}  // namespace
}  // namespace bevloc
