// Requirements that every solver meets.
#include <algorithm>
#include <limits>
#include <numeric>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/solver_name.h"
#include "tests/pipeline/solver/synthetic_scene.h"
#include "tests/support/pose_matchers.h"

namespace bevloc {
namespace {

constexpr int kSolverChannels = 16;

/// A solver with larger scales than training finds, because these features have less noise.
std::unique_ptr<Solver> make(SolverKind kind, float scale = 300.0F) {
  SolverParameters parameters;
  parameters.joint_scale = scale;
  parameters.x_scale = scale;
  parameters.y_scale = scale;
  parameters.yaw_scale = scale;
  parameters.refine_x_scale = scale;
  parameters.refine_y_scale = scale;
  parameters.refine_yaw_scale = scale;
  parameters.banded_x_scale = scale;
  parameters.banded_y_scale = scale;
  return make_solver(kind, kFeatureGrid, kSolverChannels, HypothesisGrid{}, parameters).value();
}

SolverResult solve(Solver& solver, const std::vector<float>& bev, const std::vector<float>& map) {
  SolverResult result;
  solver.solve(view(bev, kSolverChannels, kFeatureGrid), view(map, kSolverChannels, kFeatureGrid),
               result);
  return result;
}

void expect_usable(const SolverResult& result) {
  for (const auto* distribution :
       {&result.x_probability, &result.y_probability, &result.yaw_probability}) {
    EXPECT_NEAR(std::accumulate(distribution->begin(), distribution->end(), 0.0), 1.0, 1e-5);
    EXPECT_GE(std::ranges::min(*distribution), 0.0F);
  }
  EXPECT_EQ(result.x_probability.size(), 21U);
  EXPECT_EQ(result.y_probability.size(), 11U);
  EXPECT_EQ(result.yaw_probability.size(), 21U);
  EXPECT_TRUE(result.correction.is_finite());
  EXPECT_TRUE(result.covariance.allFinite());
  const Eigen::Vector3d least = least_variance(HypothesisGrid{});
  for (int i = 0; i < 3; ++i) EXPECT_GE(result.covariance(i, i), least(i) * (1.0 - 1e-9));
  EXPECT_TRUE(result.covariance.isApprox(result.covariance.transpose(), 1e-12));
  EXPECT_EQ(result.covariance.llt().info(), Eigen::Success);
}

struct Accuracy {
  SolverKind kind;
  double position_m;
  double yaw_rad;
};

class EverySolver : public testing::TestWithParam<Accuracy> {};

TEST_P(EverySolver, RecoversKnownCorrections) {
  const auto solver = make(GetParam().kind);
  const Se2 truths[] = {{0.0, 0.0, 0.0},
                        {1.37, -0.52, radians(0.73)},
                        {-1.61, 0.66, radians(-1.21)},
                        {0.31, 0.77, radians(1.55)},
                        {-0.2, -0.4, radians(-0.6)}};
  unsigned seed = 1;
  for (const Se2& truth : truths) {
    const SyntheticScene scene = SyntheticScene::structured(kSolverChannels, seed++);
    const SolverResult result =
        solve(*solver, scene.seen_from(truth, kFeatureGrid), scene.seen_from({}, kFeatureGrid));
    EXPECT_EQ(result.evidence, Evidence::kGood);
    EXPECT_THAT(result.correction, test::PoseNear(truth, GetParam().position_m, GetParam().yaw_rad))
        << "seed " << seed;
    expect_usable(result);
  }
}

TEST_P(EverySolver, PointsForwardAndLeft) {
  // In the map, the post is 1 m further ahead and 0.6 m further left than in the BEV features. The
  // vehicle is therefore 1 m further ahead and 0.6 m further left than the prior.
  const auto solver = make(GetParam().kind);
  SyntheticScene map_scene(kSolverChannels);
  SyntheticScene bev_scene(kSolverChannels);
  for (int channel = 0; channel < kSolverChannels; ++channel) {
    map_scene.add({channel, 5.0, 2.0, 1.5, 1.5, 1.0});
    bev_scene.add({channel, 4.0, 1.4, 1.5, 1.5, 1.0});
  }
  const SolverResult result =
      solve(*solver, bev_scene.seen_from({}, kFeatureGrid), map_scene.seen_from({}, kFeatureGrid));
  // A single round post does not constrain yaw, and an error in yaw changes y.
  EXPECT_NEAR(result.correction.x_m, 1.0, 0.15);
  EXPECT_GT(result.correction.y_m, 0.3);
}

TEST_P(EverySolver, YawIsCounterClockwise) {
  const auto solver = make(GetParam().kind);
  const SyntheticScene scene = SyntheticScene::straight_road(kSolverChannels, 3);
  const SolverResult result =
      solve(*solver, scene.seen_from({0.0, 0.0, radians(1.0)}, kFeatureGrid),
            scene.seen_from({}, kFeatureGrid));
  EXPECT_NEAR(degrees(result.correction.yaw_rad), 1.0, 0.2);
}

TEST_P(EverySolver, RepeatsItsResult) {
  const SyntheticScene scene = SyntheticScene::structured(kSolverChannels, 9);
  const auto bev = scene.seen_from({0.5, 0.2, radians(0.3)}, kFeatureGrid);
  const auto map = scene.seen_from({}, kFeatureGrid);
  const auto first_solver = make(GetParam().kind);
  const auto second_solver = make(GetParam().kind);
  const SolverResult first = solve(*first_solver, bev, map);
  solve(*second_solver, map, bev);
  const SolverResult second = solve(*second_solver, bev, map);
  EXPECT_EQ(first.x_probability, second.x_probability);
  EXPECT_EQ(first.y_probability, second.y_probability);
  EXPECT_EQ(first.yaw_probability, second.yaw_probability);
  EXPECT_EQ(first.covariance, second.covariance);
}

TEST_P(EverySolver, ReportsWhenThereIsNothingToMatch) {
  const auto solver = make(GetParam().kind);
  const SyntheticScene scene = SyntheticScene::structured(kSolverChannels, 2);
  auto good = scene.seen_from({}, kFeatureGrid);
  std::vector<float> zeros(good.size(), 0.0F);
  std::vector<float> constant(good.size(), 0.1F);
  auto with_nan = good;
  with_nan[4321] = std::numeric_limits<float>::quiet_NaN();
  auto with_infinity = good;
  with_infinity[17] = -std::numeric_limits<float>::infinity();
  std::vector<float> empty;
  for (const std::vector<float>* bad : {&zeros, &constant, &with_nan, &with_infinity, &empty}) {
    for (const bool bad_map : {false, true}) {
      const SolverResult result = bad_map ? solve(*solver, good, *bad) : solve(*solver, *bad, good);
      EXPECT_EQ(result.evidence, Evidence::kNone);
      EXPECT_THAT(result.correction, test::PoseNear({}, 0.0, 0.0));
      EXPECT_THAT(result.y_probability, testing::Each(testing::FloatEq(1.0F / 11.0F)));
      EXPECT_EQ(result.covariance,
                Eigen::Matrix3d(uniform_variance(HypothesisGrid{}).asDiagonal()));
      expect_usable(result);
    }
  }
  EXPECT_EQ(solve(*solver, good, good).evidence, Evidence::kGood)
      << "bad input must not affect later calls";
}

TEST_P(EverySolver, SurvivesHugeAndUselessFeatures) {
  const auto solver = make(GetParam().kind);
  std::vector<float> huge(static_cast<size_t>(kSolverChannels) * kFeatureGrid.cells());
  for (size_t i = 0; i < huge.size(); ++i) {
    huge[i] = (i * 2654435761U >> 7) % 2 == 0 ? 3e38F : -3e38F;
  }
  std::vector<float> one_cell(huge.size(), 0.0F);
  one_cell[0] = 1.0F;
  std::vector<float> huge_cell(huge.size(), -3e38F);  // differences overflow a float
  huge_cell[0] = 3e38F;
  expect_usable(solve(*solver, huge, one_cell));
  expect_usable(solve(*solver, huge_cell, huge));
  expect_usable(solve(*solver, one_cell, one_cell));
}

INSTANTIATE_TEST_SUITE_P(
    Solvers, EverySolver,
    testing::Values(Accuracy{SolverKind::kFull, 0.05, radians(0.1)},
                    Accuracy{SolverKind::kFullFft, 0.05, radians(0.1)},
                    Accuracy{SolverKind::kDecoupledLiteralRefined, 0.08, radians(0.15)},
                    Accuracy{SolverKind::kDecoupled, 0.15, radians(0.3)},
                    Accuracy{SolverKind::kDecoupledRefined, 0.05, radians(0.1)},
                    Accuracy{SolverKind::kBanded, 0.15, radians(0.3)},
                    Accuracy{SolverKind::kBandedRefined, 0.05, radians(0.1)},
                    Accuracy{SolverKind::kBlock, 0.08, radians(0.15)},
                    Accuracy{SolverKind::kBlockRefined, 0.05, radians(0.1)}),
    kSolverName);

}  // namespace
}  // namespace bevloc
