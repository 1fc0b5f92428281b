#include "pipeline/solver/reference/joint_volume.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

constexpr BevGrid kVolumeGrid{20, 12, 0.6};
constexpr int kVolumeChannels = 3;

std::vector<float> random_features(unsigned seed, const BevGrid& grid = kVolumeGrid) {
  std::mt19937 engine(seed);
  std::normal_distribution<float> normal;
  std::vector<float> features(static_cast<size_t>(kVolumeChannels) * grid.cells());
  std::ranges::generate(features, [&] { return normal(engine); });
  return features;
}

/// Keys' convolution kernel with a = -1/2.
double keys(double distance) {
  const double s = std::abs(distance);
  if (s < 1.0) return 1.5 * s * s * s - 2.5 * s * s + 1.0;
  if (s < 2.0) return -0.5 * s * s * s + 2.5 * s * s - 4.0 * s + 2.0;
  return 0.0;
}

/// One score, computed from the definition in joint_volume.h without any code of JointVolume.
double defined_score(const std::vector<float>& bev, const std::vector<float>& map,
                     const BevGrid& grid, int block_cells, const Se2& hypothesis) {
  const auto at = [&grid](const std::vector<float>& f, int c, int row, int col) -> double {
    const bool inside = row >= 0 && row < grid.rows && col >= 0 && col < grid.cols;
    return inside ? f[(c * grid.rows + row) * grid.cols + col] : 0.0;
  };
  double total = 0.0;
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const int first_row = row / block_cells * block_cells;
      const int first_col = col / block_cells * block_cells;
      const int last_row = std::min(first_row + block_cells, grid.rows) - 1;
      const int last_col = std::min(first_col + block_cells, grid.cols) - 1;
      const Eigen::Vector2d centre(grid.x_of_row(0.5 * (first_row + last_row)),
                                   grid.y_of_col(0.5 * (first_col + last_col)));
      const Eigen::Vector2d cells = -(hypothesis * centre - centre) / grid.cell_m;
      for (int m = -9; m <= 9; ++m) {
        for (int n = -9; n <= 9; ++n) {
          const double weight = keys(m - cells.x()) * keys(n - cells.y());
          for (int c = 0; weight != 0.0 && c < kVolumeChannels; ++c) {
            total += weight * at(bev, c, row, col) * at(map, c, row + m, col + n);
          }
        }
      }
    }
  }
  return total / (kVolumeChannels * grid.cells());
}

float score_at(const std::vector<float>& volume, const HypothesisGrid& h, int a, int i, int j) {
  return volume[(a * h.x_m.count() + i) * h.y_m.count() + j];
}

TEST(JointVolume, FollowsItsDefinition) {
  const auto bev = random_features(1);
  const auto map = random_features(2);
  const HypothesisGrid hypotheses;
  JointVolume joint(hypotheses, kVolumeGrid, kVolumeChannels);
  std::vector<float> volume(joint.hypothesis_count());
  joint.scores(bev, map, volume);
  for (const int a : {0, 7, 20}) {
    for (const int i : {0, 10, 13, 20}) {
      for (const int j : {0, 5, 10}) {
        const Se2 hypothesis{hypotheses.x_m.value(i), hypotheses.y_m.value(j),
                             hypotheses.yaw_rad.value(a)};
        EXPECT_NEAR(score_at(volume, hypotheses, a, i, j),
                    defined_score(bev, map, kVolumeGrid, 5, hypothesis), 1e-5);
      }
    }
  }
}

TEST(JointVolume, FollowsItsDefinitionWithOtherSizes) {
  const BevGrid grid{13, 9, 0.5};
  HypothesisGrid hypotheses;
  hypotheses.x_m = {1.0, 0.5};
  hypotheses.y_m = {3.0, 0.25};  // more hypotheses and more shifts than one vector holds
  hypotheses.yaw_rad = {radians(10.0), radians(5.0)};
  const auto bev = random_features(3, grid);
  const auto map = random_features(4, grid);
  JointVolume joint(hypotheses, grid, kVolumeChannels, 4);
  std::vector<float> volume(joint.hypothesis_count());
  joint.scores(bev, map, volume);
  for (const int a : {0, 2, 4}) {
    for (const int j : {0, 11, 16, 24}) {
      const Se2 hypothesis{hypotheses.x_m.value(3), hypotheses.y_m.value(j),
                           hypotheses.yaw_rad.value(a)};
      EXPECT_NEAR(score_at(volume, hypotheses, a, 3, j),
                  defined_score(bev, map, grid, 4, hypothesis), 1e-5);
    }
  }
}

TEST(JointVolume, EqualFeaturesPeakAtNoCorrection) {
  const auto features = random_features(5);
  const HypothesisGrid hypotheses;
  JointVolume joint(hypotheses, kVolumeGrid, kVolumeChannels);
  std::vector<float> volume(joint.hypothesis_count());
  joint.scores(features, features, volume);
  const auto peak = std::ranges::max_element(volume) - volume.begin();
  EXPECT_EQ(peak, (10 * 21 + 10) * 11 + 5);
}

TEST(JointVolume, SignsOfTranslation) {
  // In the map, the mark is two cells further ahead and one cell further left than in the BEV
  // features. The vehicle is therefore 1.2 m further ahead and 0.6 m further left than T0.
  std::vector<float> bev(kVolumeChannels * kVolumeGrid.cells(), 0.0F);
  std::vector<float> map = bev;
  bev[10 * kVolumeGrid.cols + 6] = 1.0F;
  map[8 * kVolumeGrid.cols + 5] = 1.0F;
  const HypothesisGrid hypotheses;
  JointVolume joint(hypotheses, kVolumeGrid, kVolumeChannels);
  std::vector<float> volume(joint.hypothesis_count());
  joint.scores(bev, map, volume);
  const float straight = score_at(volume, hypotheses, 10, 16, 8);
  EXPECT_NEAR(straight, 1.0 / (kVolumeChannels * kVolumeGrid.cells()), 1e-7);
  EXPECT_NEAR(*std::ranges::max_element(volume), straight, 1e-4F * straight);
}

TEST(JointVolume, GradientsMatchFiniteDifferences) {
  const auto bev = random_features(6);
  const auto map = random_features(7);
  JointVolume joint(HypothesisGrid{}, kVolumeGrid, kVolumeChannels);
  std::vector<float> volume(joint.hypothesis_count());
  std::vector<float> direction(volume.size());
  std::mt19937 engine(8);
  std::normal_distribution<float> normal;
  std::ranges::generate(direction, [&] { return normal(engine); });
  const auto objective = [&](const std::vector<float>& b, const std::vector<float>& m) {
    joint.scores(b, m, volume);
    double sum = 0.0;
    for (size_t i = 0; i < volume.size(); ++i) {
      sum += static_cast<double>(volume[i]) * direction[i];
    }
    return sum;
  };
  std::vector<float> grad_bev(bev.size());
  std::vector<float> grad_map(map.size());
  joint.gradients(bev, map, direction, grad_bev, grad_map);
  // The scores are linear in each side, so finite differences are exact for any step.
  const double base = objective(bev, map);
  for (const size_t i : {size_t{0}, size_t{77}, size_t{250}, bev.size() - 1}) {
    auto moved = bev;
    moved[i] += 1.0F;
    EXPECT_NEAR(objective(moved, map) - base, grad_bev[i], 1e-4);
    moved = map;
    moved[i] += 1.0F;
    EXPECT_NEAR(objective(bev, moved) - base, grad_map[i], 1e-4);
  }
}

TEST(JointVolume, RepeatsItsScores) {
  const auto bev = random_features(9);
  const auto map = random_features(10);
  JointVolume joint(HypothesisGrid{}, kVolumeGrid, kVolumeChannels);
  std::vector<float> first(joint.hypothesis_count());
  std::vector<float> second(first.size());
  std::vector<float> gradient(bev.size());
  std::vector<float> other(bev.size());
  joint.scores(bev, map, first);
  joint.gradients(bev, map, first, gradient, other);
  joint.scores(bev, map, second);
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace bevloc
