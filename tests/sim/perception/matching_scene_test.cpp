#include "sim/perception/matching_scene.h"

#include <array>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "pipeline/map/rasterizer.h"

namespace bevloc::sim {
namespace {

/// Intersection over union of perceived and true cells per class, over many scenes.
std::array<double, kRasterChannels> overlap(CorruptionLevel level, uint64_t scenes) {
  SceneSampler sampler(kTuningSeedBase);
  MatchingScene scene;
  std::array<double, kRasterChannels> both{};
  std::array<double, kRasterChannels> either{};
  for (uint64_t i = 0; i < scenes; ++i) {
    sampler.make(i, level, scene);
    for (size_t k = 0; k < kRasterSize; ++k) {
      const bool seen = scene.perceived[k] > 0.5F;
      const bool there = scene.raster_truth[k] > 127;
      both[k / kRasterGrid.cells()] += seen && there ? 1.0 : 0.0;
      either[k / kRasterGrid.cells()] += seen || there ? 1.0 : 0.0;
    }
  }
  for (size_t k = 0; k < both.size(); ++k) both[k] /= either[k];
  return both;
}

bool equal(const MatchingScene& a, const MatchingScene& b) {
  return a.kind == b.kind && a.correction.x_m == b.correction.x_m &&
         a.correction.y_m == b.correction.y_m && a.correction.yaw_rad == b.correction.yaw_rad &&
         a.raster_prior == b.raster_prior && a.raster_truth == b.raster_truth &&
         a.perceived == b.perceived;
}

TEST(SceneSampler, ASceneDependsOnSeedBaseAndNumberAlone) {
  SceneSampler in_order(kTuningSeedBase);
  SceneSampler backwards(kTuningSeedBase);
  std::array<MatchingScene, 44> scenes;  // more than one group
  for (size_t i = 0; i < scenes.size(); ++i) {
    in_order.make(i, CorruptionLevel::kPaper, scenes[i]);
  }
  MatchingScene again;
  for (const size_t i : {43U, 41U, 7U, 0U}) {
    backwards.make(i, CorruptionLevel::kPaper, again);
    EXPECT_TRUE(equal(again, scenes[i])) << i;
  }
}

TEST(SceneSampler, SeedBasesGiveDifferentScenes) {
  MatchingScene tuning;
  MatchingScene evaluation;
  SceneSampler(kTuningSeedBase).make(0, CorruptionLevel::kClean, tuning);
  SceneSampler(kEvaluationSeedBase).make(0, CorruptionLevel::kClean, evaluation);
  EXPECT_NE(tuning.raster_truth, evaluation.raster_truth);
}

TEST(SceneSampler, TheLevelAffectsOnlyThePerceivedMask) {
  SceneSampler sampler(kTuningSeedBase);
  MatchingScene clean;
  MatchingScene hard;
  sampler.make(3, CorruptionLevel::kClean, clean);
  sampler.make(3, CorruptionLevel::kHard, hard);
  EXPECT_NE(clean.perceived, hard.perceived);
  hard.perceived = clean.perceived;
  EXPECT_TRUE(equal(clean, hard));
}

TEST(SceneSampler, EveryKindOfRoadIsEquallyFrequent) {
  SceneSampler sampler(kTuningSeedBase);
  MatchingScene scene;
  std::array<int, kRoadKinds> counts{};
  for (uint64_t i = 0; i < 40; ++i) {
    sampler.make(i, CorruptionLevel::kClean, scene);
    ++counts[static_cast<size_t>(scene.kind)];
  }
  for (const int count : counts) EXPECT_EQ(count, 8);
}

TEST(SceneSampler, EveryKindOfRoadComesEquallyFromBothKindsOfMap) {
  SceneSampler sampler(kTuningSeedBase);
  MatchingScene scene;
  std::array<int, kRoadKinds> surveyed{};
  for (uint64_t i = 0; i < 40; ++i) {
    sampler.make(i, CorruptionLevel::kClean, scene);
    surveyed[static_cast<size_t>(scene.kind)] += scene.surveyed ? 1 : 0;
  }
  for (const int count : surveyed) EXPECT_EQ(count, 4);
}

/// The number of stretches of covered cells along the columns of the divider raster.
int divider_stretches(const std::vector<uint8_t>& raster) {
  int stretches = 0;
  for (int col = 0; col < kRasterGrid.cols; ++col) {
    bool covered = false;
    for (int row = 0; row < kRasterGrid.rows; ++row) {
      const bool now = raster[static_cast<size_t>(row) * kRasterGrid.cols + col] > 127;
      stretches += now && !covered ? 1 : 0;
      covered = now;
    }
  }
  return stretches;
}

// Tests straight roads, where dashes lie along the columns of the raster.
TEST(SceneSampler, SurveyedMapsShowDashes) {
  SceneSampler sampler(kTuningSeedBase);
  MatchingScene scene;
  std::array<int, 2> stretches{};
  for (uint64_t i = 1; i < 200; i += kRoadKinds) {
    sampler.make(i, CorruptionLevel::kClean, scene);
    ASSERT_EQ(scene.kind, RoadKind::kStraightStructured);
    stretches[scene.surveyed ? 1 : 0] += divider_stretches(scene.raster_prior);
  }
  EXPECT_GT(stretches[1], 2 * stretches[0]);
}

TEST(SceneSampler, ScenesOfATownAreNotRepeated) {
  SceneSampler sampler(kTuningSeedBase);
  MatchingScene scene;
  std::set<std::pair<double, double>> places;
  for (uint64_t i = 0; i < 80; ++i) {
    sampler.make(i, CorruptionLevel::kClean, scene);
    places.insert({scene.map_from_vehicle.x_m, scene.map_from_vehicle.y_m});
  }
  EXPECT_EQ(places.size(), 80U);
}

TEST(SceneSampler, CorrectionsFillTheirRanges) {
  const HypothesisGrid ranges{{1.0, 0.1}, {0.5, 0.1}, {radians(4.0), radians(0.1)}};
  SceneSampler sampler(kTuningSeedBase, ranges);
  MatchingScene scene;
  Se2 most;
  for (uint64_t i = 0; i < 80; ++i) {
    sampler.make(i, CorruptionLevel::kClean, scene);
    most.x_m = std::max(most.x_m, std::abs(scene.correction.x_m));
    most.y_m = std::max(most.y_m, std::abs(scene.correction.y_m));
    most.yaw_rad = std::max(most.yaw_rad, std::abs(scene.correction.yaw_rad));
  }
  EXPECT_LE(most.x_m, 1.0);
  EXPECT_LE(most.y_m, 0.5);
  EXPECT_LE(most.yaw_rad, radians(4.0));
  EXPECT_GT(most.x_m, 0.85);
  EXPECT_GT(most.y_m, 0.42);
  EXPECT_GT(most.yaw_rad, radians(3.4));
}

// Moving the map drawn at T0 by dT (rotation, then translation) gives the map at T.
TEST(SceneSampler, TheCorrectionMovesThePriorToTheTruth) {
  SceneSampler sampler(kTuningSeedBase);
  MatchingScene scene;
  for (uint64_t i = 0; i < 10; ++i) {
    sampler.make(i, CorruptionLevel::kClean, scene);
    int covered = 0;
    int off = 0;
    for (int row = 0; row < kRasterGrid.rows; ++row) {
      for (int col = 0; col < kRasterGrid.cols; ++col) {
        const size_t cell = static_cast<size_t>(row) * kRasterGrid.cols + col;
        if (scene.raster_truth[2 * kRasterGrid.cells() + cell] < 250) continue;
        const Eigen::Vector2d at_prior =
            scene.correction *
            Eigen::Vector2d(kRasterGrid.x_of_row(row), kRasterGrid.y_of_col(col));
        const auto prior_row = static_cast<int>(std::lround(kRasterGrid.row_of_x(at_prior.x())));
        const auto prior_col = static_cast<int>(std::lround(kRasterGrid.col_of_y(at_prior.y())));
        if (prior_row < 0 || prior_row >= kRasterGrid.rows) continue;
        if (prior_col < 0 || prior_col >= kRasterGrid.cols) continue;
        const size_t prior_cell = static_cast<size_t>(prior_row) * kRasterGrid.cols + prior_col;
        ++covered;
        off += scene.raster_prior[2 * kRasterGrid.cells() + prior_cell] < 40 ? 1 : 0;
      }
    }
    EXPECT_GT(covered, 300) << i;
    EXPECT_LT(off, covered / 100) << i;
  }
}

TEST(SceneSampler, CleanScenesShowTheMap) {
  for (const double iou : overlap(CorruptionLevel::kClean, 10)) EXPECT_GT(iou, 0.995);
}

// Expects the values of the paper's Table II; a few dozen scenes vary by some hundredths.
TEST(SceneSampler, PaperScenesReachTheIouOfThePaper) {
  const auto iou = overlap(CorruptionLevel::kPaper, 80);
  EXPECT_NEAR(iou[0], 0.578, 0.06);
  EXPECT_NEAR(iou[1], 0.422, 0.08);
  EXPECT_NEAR(iou[2], 0.578, 0.06);
}

}  // namespace
}  // namespace bevloc::sim
