// The covariance must be large along axes that a scene does not constrain.
#include <gtest/gtest.h>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

constexpr int kCovarianceChannels = 16;

/// Adds structure of strength `clutter` to the BEV features that the map does not have.
SolverResult solve(const SyntheticScene& scene, const Se2& truth, float clutter, unsigned seed) {
  const SolverParameters sharp{.joint_scale = 300.0F};
  auto solver = make_solver(SolverKind::kDecoupled, kFeatureGrid, kCovarianceChannels,
                            HypothesisGrid{}, sharp)
                    .value();
  auto bev = scene.seen_from(truth, kFeatureGrid);
  const auto map = scene.seen_from({}, kFeatureGrid);
  const auto unknown =
      SyntheticScene::structured(kCovarianceChannels, seed + 1000).seen_from({}, kFeatureGrid);
  for (size_t i = 0; i < bev.size(); ++i) bev[i] += clutter * unknown[i];
  SolverResult result;
  solver->solve(view(bev, kCovarianceChannels, kFeatureGrid),
                view(map, kCovarianceChannels, kFeatureGrid), result);
  return result;
}

TEST(MatchCovarianceTest, BecomesUniformAlongAStraightRoad) {
  const Eigen::Vector3d uniform = uniform_variance(HypothesisGrid{});
  for (unsigned seed = 0; seed < 4; ++seed) {
    const SyntheticScene road = SyntheticScene::straight_road(kCovarianceChannels, seed);
    for (const float noise : {0.0F, 0.3F}) {
      const SolverResult result = solve(road, {1.5, 0.3, 0.0}, noise, seed);
      EXPECT_GT(result.covariance(0, 0), 0.9 * uniform(0)) << "seed " << seed;
      EXPECT_LT(result.covariance(1, 1), 0.1 * uniform(1)) << "seed " << seed;
      EXPECT_LT(result.covariance(2, 2), 0.15 * uniform(2)) << "seed " << seed;
    }
  }
}

TEST(MatchCovarianceTest, CorrelatesXAndYOnADiagonalRoad) {
  // The position along the road is not constrained, so the errors of x and y are correlated.
  SyntheticScene road(kCovarianceChannels);
  for (int channel = 0; channel < kCovarianceChannels; ++channel) {
    for (int i = -40; i <= 40; ++i) {  // a solid line from the right rear to the left front
      road.add({channel, 1.0 * i, 0.3 * i + channel - 8.0, 1.0, 1.0, 1.0});
    }
  }
  const Eigen::Matrix3d covariance = solve(road, {}, 0.1F, 1).covariance;
  EXPECT_GT(covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1)), 0.5);
}

TEST(MatchCovarianceTest, ShrinksWithStructure) {
  const Eigen::Vector3d uniform = uniform_variance(HypothesisGrid{});
  const SyntheticScene scene = SyntheticScene::structured(kCovarianceChannels, 5);
  const SolverResult result = solve(scene, {0.7, -0.3, radians(0.5)}, 0.1F, 5);
  EXPECT_LT(result.covariance(0, 0), 0.05 * uniform(0));
  EXPECT_LT(result.covariance(1, 1), 0.15 * uniform(1));
  EXPECT_LT(result.covariance(2, 2), 0.15 * uniform(2));
}

TEST(MatchCovarianceTest, GrowsWithClutter) {
  const SyntheticScene scene = SyntheticScene::structured(kCovarianceChannels, 6);
  const Eigen::Vector3d quiet = solve(scene, {}, 0.1F, 6).covariance.diagonal();
  const Eigen::Vector3d loud = solve(scene, {}, 1.5F, 6).covariance.diagonal();
  for (int i = 0; i < 3; ++i) EXPECT_GT(loud(i), quiet(i));
}

TEST(MatchCovarianceTest, CoversTheErrors) {
  // Errors divided by the claimed sigma, on straight roads and on structured scenes.
  constexpr int kScenes = 24;
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  int beyond_3_sigma = 0;
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    const bool straight = seed % 3 == 0;
    const SyntheticScene scene = straight ? SyntheticScene::straight_road(kCovarianceChannels, seed)
                                          : SyntheticScene::structured(kCovarianceChannels, seed);
    const Se2 truth{1.8 * std::sin(2.0 * seed + 1.0), 0.8 * std::sin(3.0 * seed + 2.0),
                    radians(1.5 * std::sin(5.0 * seed + 3.0))};
    const SolverResult result = solve(scene, truth, 1.0F, seed);
    const Eigen::Array3d error(result.correction.x_m - truth.x_m, result.correction.y_m - truth.y_m,
                               result.correction.yaw_rad - truth.yaw_rad);
    const Eigen::Array3d normalised = error / result.covariance.diagonal().array().sqrt();
    squares += normalised.square();
    beyond_3_sigma += static_cast<int>((normalised.abs() > 3.0).count());
  }
  for (int i = 0; i < 3; ++i) EXPECT_LT(squares(i) / kScenes, 2.0) << "axis " << i;
  EXPECT_LE(beyond_3_sigma, 1);
}

}  // namespace
}  // namespace bevloc
