// Accuracy of the solvers for known corrections that lie anywhere between the hypotheses.
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/solver_name.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

constexpr double kPosition_m = 0.02;
constexpr double kYaw_deg = 0.05;

/// Features of one scene of smooth bumps (sigma 0.7 to 1.4 m), seen from random corrections.
struct Recordings {
  Recordings(const BevGrid& grid_in, int channels_in, int count)
      : grid(grid_in), channels(channels_in) {
    const SyntheticScene scene = SyntheticScene::structured(channels, 1);
    map = scene.seen_from({}, grid);
    // They are at least one step away from the ends, because the parabola needs a hypothesis on
    // both sides.
    std::mt19937 random(2026);
    std::uniform_real_distribution<double> x_m(-1.8, 1.8);
    std::uniform_real_distribution<double> y_m(-0.8, 0.8);
    std::uniform_real_distribution<double> yaw_deg(-1.8, 1.8);
    for (int i = 0; i < count; ++i) {
      truths.push_back({x_m(random), y_m(random), radians(yaw_deg(random))});
      bevs.push_back(scene.seen_from(truths.back(), grid));
    }
  }

  BevGrid grid;
  int channels;
  std::vector<float> map;
  std::vector<Se2> truths;
  std::vector<std::vector<float>> bevs;
};

/// Measures the error of the parabola, which does not depend on the scales. The mean does: a broad
/// distribution is truncated at the ends of the range, and a sharp one snaps to a hypothesis.
void expect_recovery(SolverKind kind, const Recordings& recordings, double position_m,
                     double yaw_deg) {
  auto solver = make_solver(kind, recordings.grid, recordings.channels, {}, {}).value();
  SolverResult result;
  Se2 worst;
  for (size_t i = 0; i < recordings.truths.size(); ++i) {
    solver->solve(view(recordings.bevs[i], recordings.channels, recordings.grid),
                  view(recordings.map, recordings.channels, recordings.grid), result);
    ASSERT_EQ(result.evidence, Evidence::kGood);
    const Se2& truth = recordings.truths[i];
    worst.x_m = std::max(worst.x_m, std::abs(result.parabola.x_m - truth.x_m));
    worst.y_m = std::max(worst.y_m, std::abs(result.parabola.y_m - truth.y_m));
    worst.yaw_rad = std::max(worst.yaw_rad, std::abs(result.parabola.yaw_rad - truth.yaw_rad));
  }
  EXPECT_LE(worst.x_m, position_m);
  EXPECT_LE(worst.y_m, position_m);
  EXPECT_LE(degrees(worst.yaw_rad), yaw_deg);
  testing::Test::RecordProperty("worst_x_m", std::to_string(worst.x_m));
  testing::Test::RecordProperty("worst_y_m", std::to_string(worst.y_m));
  testing::Test::RecordProperty("worst_yaw_deg", std::to_string(degrees(worst.yaw_rad)));
}

struct Bound {
  SolverKind kind;
  double position_m = kPosition_m;
  double yaw_deg = kYaw_deg;
};

class Recovery : public testing::TestWithParam<Bound> {};

TEST_P(Recovery, OnTheFeatureGrid) {
  static const Recordings recordings(kFeatureGrid, 16, 24);
  expect_recovery(GetParam().kind, recordings, GetParam().position_m, GetParam().yaw_deg);
}

// Two solvers have a larger bound:
// - block: it does not normalise by the moved features inside the grid, so the border biases it.
//   Standardised empty ground lies below zero, and outside the grid the features are zero; these
//   edges fit best without a shift. (For features with mean zero it is accurate to 0.01 m.)
// - banded: a shift along one axis moves structure across the borders of the other axis's bands.
// The literal solver without refinement is missing, because its yaw is not accurate.
INSTANTIATE_TEST_SUITE_P(
    Solvers, Recovery,
    testing::Values(Bound{SolverKind::kFull}, Bound{SolverKind::kFullFft},
                    Bound{SolverKind::kDecoupled}, Bound{SolverKind::kDecoupledRefined},
                    Bound{SolverKind::kBandedRefined}, Bound{SolverKind::kBlockRefined},
                    Bound{SolverKind::kDecoupledLiteralRefined},
                    Bound{SolverKind::kBlock, 0.04, 0.1}, Bound{SolverKind::kBanded, 0.12, 0.25}),
    kSolverName);

class FineRecovery : public testing::TestWithParam<Bound> {};

TEST_P(FineRecovery, OnTheRasterGrid) {
  static const Recordings recordings(kRasterGrid, 4, 4);
  expect_recovery(GetParam().kind, recordings, GetParam().position_m, GetParam().yaw_deg);
}

INSTANTIATE_TEST_SUITE_P(Solvers, FineRecovery,
                         testing::Values(Bound{SolverKind::kDecoupledRefined},
                                         Bound{SolverKind::kBandedRefined}),
                         kSolverName);

}  // namespace
}  // namespace bevloc
