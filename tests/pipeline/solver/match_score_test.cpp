// The score must tell a match of the right place from the best match of a wrong one.
#include "pipeline/solver/match_score.h"

#include <gtest/gtest.h>

#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

constexpr int kScoreChannels = 16;

SolverResult match(const std::vector<float>& bev, const std::vector<float>& map,
                   const SolverParameters& parameters = {}) {
  auto solver =
      make_solver(SolverKind::kBandedRefined, kFeatureGrid, kScoreChannels, {}, parameters).value();
  SolverResult result;
  solver->solve(view(bev, kScoreChannels, kFeatureGrid), view(map, kScoreChannels, kFeatureGrid),
                result);
  return result;
}

TEST(MatchScoreTest, IsNearOneWhereBothSidesShowTheSamePlace) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const SyntheticScene scene = SyntheticScene::structured(kScoreChannels, seed);
    const SolverResult result = match(scene.seen_from({0.7, -0.3, radians(0.7)}, kFeatureGrid),
                                      scene.seen_from({}, kFeatureGrid));
    EXPECT_GT(result.score, 0.95) << "seed " << seed;
    EXPECT_GT(result.axis_score.minCoeff(), 0.95) << "seed " << seed;
    EXPECT_LT(result.edge_mass.maxCoeff(), 0.05) << "seed " << seed;
  }
}

TEST(MatchScoreTest, IsSmallWhereTheMapShowsAnotherPlace) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const SolverResult result =
        match(SyntheticScene::structured(kScoreChannels, seed).seen_from({}, kFeatureGrid),
              SyntheticScene::structured(kScoreChannels, seed + 100).seen_from({}, kFeatureGrid));
    EXPECT_LT(result.score, 0.25) << "seed " << seed;
    EXPECT_LT(result.axis_score.maxCoeff(), 0.25) << "seed " << seed;
  }
}

TEST(MatchScoreTest, IsSmallWhereTheTruthLiesOutsideTheSearchRange) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const SyntheticScene scene = SyntheticScene::structured(kScoreChannels, seed);
    const SolverResult result =
        match(scene.seen_from({0.0, 4.0, 0.0}, kFeatureGrid), scene.seen_from({}, kFeatureGrid));
    EXPECT_LT(result.score, 0.3) << "seed " << seed;
  }
}

TEST(MatchScoreTest, OnlyTheWholeScoreIsScaled) {
  const SyntheticScene scene = SyntheticScene::structured(kScoreChannels, 1);
  const std::vector<float> bev = scene.seen_from({0.7, -0.3, radians(0.7)}, kFeatureGrid);
  const std::vector<float> map = scene.seen_from({}, kFeatureGrid);
  SolverParameters parameters;
  parameters.score_scale = 1.25F;
  const SolverResult plain = match(bev, map);
  const SolverResult scaled = match(bev, map, parameters);
  EXPECT_DOUBLE_EQ(scaled.score, 1.25 * plain.score);
  EXPECT_EQ(scaled.axis_score, plain.axis_score);
  EXPECT_EQ(scaled.covariance, plain.covariance);
}

TEST(MatchScoreTest, TheEdgeMassShowsATruthAtTheBorder) {
  const SyntheticScene scene = SyntheticScene::structured(kScoreChannels, 3);
  const SolverResult result =
      match(scene.seen_from({0.0, 1.0, 0.0}, kFeatureGrid), scene.seen_from({}, kFeatureGrid));
  EXPECT_GT(result.edge_mass(1), 0.9);
  EXPECT_LT(result.edge_mass(0), 0.1);
}

TEST(MatchScoreTest, JudgesEachAxisByWhatShowsIt) {
  // Both sides agree on the lane lines, but the stop lines of the map are elsewhere.
  SyntheticScene perceived = SyntheticScene::straight_road(kScoreChannels, 1);
  SyntheticScene mapped = perceived;
  for (int channel = 0; channel < kScoreChannels; ++channel) {
    perceived.add({channel, 12.0, 0.0, 0.8, 3.0, 1.0});
    mapped.add({channel, -12.0, 0.0, 0.8, 3.0, 1.0});
  }
  const SolverResult result =
      match(perceived.seen_from({}, kFeatureGrid), mapped.seen_from({}, kFeatureGrid));
  EXPECT_GT(result.axis_score.y(), 0.8);
  EXPECT_LT(result.axis_score.x(), 0.2);
}

TEST(MatchScoreTest, IsZeroForASideWithoutStructure) {
  const SyntheticScene scene = SyntheticScene::structured(kScoreChannels, 1);
  CellFeatures map(kFeatureGrid, kScoreChannels);
  map.assign(scene.seen_from({}, kFeatureGrid));
  const LaneBuffer constant(static_cast<size_t>(kFeatureGrid.cells()) * map.lanes(), 0.5F);
  const MatchScore score = score_match(map, constant, {}, 2);
  EXPECT_EQ(score.overlap, 0.0);
  EXPECT_TRUE(score.axis.isZero(0.0));
}

TEST(MatchScoreTest, IsZeroWhereTheBorderLeavesNoCells) {
  CellFeatures map(BevGrid{8, 8, 0.6}, kScoreChannels);
  const LaneBuffer moved(static_cast<size_t>(64) * map.lanes(), 1.0F);
  EXPECT_EQ(score_match(map, moved, {}, 4).overlap, 0.0);
}

}  // namespace
}  // namespace bevloc
