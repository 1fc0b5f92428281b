// Compares the scores by cross-correlation (full-fft) with those by warping (full).
#include <gtest/gtest.h>

#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/synthetic_scene.h"
#include "tests/support/pose_matchers.h"

namespace bevloc {
namespace {

constexpr int kFftChannels = 19;  // one vector and a part of a second

/// Hypotheses whose yaw is so small that both solvers interpolate at the same positions.
HypothesisGrid without_yaw(double x_step_m, double y_step_m) {
  return {{2.0, x_step_m}, {1.0, y_step_m}, {1e-9, 1e-9}};
}

void expect_same(const SolverResult& a, const SolverResult& b, double tolerance) {
  for (size_t i = 0; i < a.x_probability.size(); ++i) {
    EXPECT_NEAR(a.x_probability[i], b.x_probability[i], tolerance);
  }
  for (size_t i = 0; i < a.y_probability.size(); ++i) {
    EXPECT_NEAR(a.y_probability[i], b.y_probability[i], tolerance);
  }
  for (size_t i = 0; i < a.yaw_probability.size(); ++i) {
    EXPECT_NEAR(a.yaw_probability[i], b.yaw_probability[i], tolerance);
  }
}

class FullFftTest : public testing::Test {
 protected:
  SolverResult solve(SolverKind kind, const BevGrid& grid, const HypothesisGrid& hypotheses,
                     float noise = 0.3F) const {
    const auto solver = make_solver(kind, grid, kFftChannels, hypotheses, {.joint_scale = 50.0F});
    const SyntheticScene scene = SyntheticScene::structured(kFftChannels, 5);
    auto bev = scene.seen_from({0.53, -0.31, radians(0.5)}, grid);
    add_noise(bev, noise, 8);  // fine detail reveals differences in interpolation
    const auto map = scene.seen_from({}, grid);
    SolverResult result;
    (*solver)->solve(view(bev, kFftChannels, grid), view(map, kFftChannels, grid), result);
    return result;
  }
};

TEST_F(FullFftTest, IsExactWithoutRotation) {
  for (const auto& [x_step_m, y_step_m] : {std::pair(0.2, 0.2), {0.1, 0.4}, {0.6, 0.25}}) {
    const HypothesisGrid hypotheses = without_yaw(x_step_m, y_step_m);
    expect_same(solve(SolverKind::kFull, kFeatureGrid, hypotheses),
                solve(SolverKind::kFullFft, kFeatureGrid, hypotheses), 1e-5);
  }
}

TEST_F(FullFftTest, IsExactOnOtherGrids) {
  const BevGrid grid{60, 34, 0.5};
  const HypothesisGrid hypotheses = without_yaw(0.2, 0.2);
  expect_same(solve(SolverKind::kFull, grid, hypotheses),
              solve(SolverKind::kFullFft, grid, hypotheses), 1e-5);
}

TEST_F(FullFftTest, IsCloseWithRotation) {
  const SolverResult once = solve(SolverKind::kFull, kFeatureGrid, {}, 0.0F);
  const SolverResult twice = solve(SolverKind::kFullFft, kFeatureGrid, {}, 0.0F);
  // full-fft interpolates twice, full once.
  EXPECT_THAT(twice.correction, test::PoseNear(once.correction, 0.02, radians(0.05)));
}

}  // namespace
}  // namespace bevloc
