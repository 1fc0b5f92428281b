// The streamed ZNCC against ZNCC written out.
#include "pipeline/solver/translation_scorer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/solver/standardise.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

constexpr int kChannels = 19;  // a whole vector and a bit
constexpr BevGrid kGrid{24, 13, 0.5};
/// Steps that divide a cell in no small number of phases, and yaw wide enough to leave the grid.
constexpr HypothesisGrid kHypotheses{{1.5, 0.3}, {0.8, 0.4}, {0.4, 0.1}};

double moved(const float* plane, int row, int col, const Se2& correction) {
  const Eigen::Vector2d source =
      correction.inverse() * Eigen::Vector2d(kGrid.x_of_row(row), kGrid.y_of_col(col));
  const double u = kGrid.row_of_x(source.x());
  const double v = kGrid.col_of_y(source.y());
  double sum = 0.0;
  for (int i = 0; i < kGrid.rows; ++i) {
    for (int j = 0; j < kGrid.cols; ++j) {
      const double weight =
          std::max(0.0, 1.0 - std::abs(u - i)) * std::max(0.0, 1.0 - std::abs(v - j));
      sum += weight * plane[i * kGrid.cols + j];
    }
  }
  return sum;
}

double literal_zncc(const std::vector<float>& bev, const std::vector<float>& map,
                    const Se2& correction) {
  double sums[5] = {};
  for (int c = 0; c < kChannels; ++c) {
    for (int row = 0; row < kGrid.rows; ++row) {
      for (int col = 0; col < kGrid.cols; ++col) {
        const double m = map[(c * kGrid.rows + row) * kGrid.cols + col];
        const double b = moved(bev.data() + c * kGrid.cells(), row, col, correction);
        const double terms[5] = {m, b, m * m, b * b, m * b};
        for (int i = 0; i < 5; ++i) sums[i] += terms[i] / (kChannels * kGrid.cells());
      }
    }
  }
  return (sums[4] - sums[0] * sums[1]) /
         std::sqrt((sums[2] - sums[0] * sums[0]) * (sums[3] - sums[1] * sums[1]));
}

class TranslationScorerTest : public testing::Test {
 protected:
  TranslationScorerTest() {
    std::vector<float> features(bev_.size());
    for (std::vector<float>* side : {&bev_, &map_}) {
      add_noise(features, 1.0F, side == &bev_ ? 1 : 2);
      EXPECT_TRUE(standardise(view(features, kChannels, kGrid), *side));
    }
    bev_cells_.assign(bev_);
    map_cells_.assign(map_);
    scorer_.set_features(bev_cells_, map_cells_);
  }

  std::vector<float> bev_ = std::vector<float>(static_cast<size_t>(kChannels) * kGrid.cells());
  std::vector<float> map_ = bev_;
  CellFeatures bev_cells_{kGrid, kChannels, kHypotheses};
  CellFeatures map_cells_{kGrid, kChannels, kHypotheses};
  TranslationScorer scorer_{kGrid, kChannels, kHypotheses};
};

TEST_F(TranslationScorerTest, ScoresEveryHypothesisAsItIsDefined) {
  const ShiftPlan x(kHypotheses.x_m, kGrid.cell_m);
  const ShiftPlan y(kHypotheses.y_m, kGrid.cell_m);
  std::vector<double> scores(static_cast<size_t>(x.hypotheses()) * y.hypotheses());
  for (const double yaw_rad : {-0.4, 0.0, 0.17}) {
    scorer_.score(yaw_rad, x, y, scores);
    for (int i = 0; i < x.hypotheses(); ++i) {
      for (int j = 0; j < y.hypotheses(); ++j) {
        const Se2 correction{kHypotheses.x_m.value(i), kHypotheses.y_m.value(j), yaw_rad};
        EXPECT_NEAR(scores[i * y.hypotheses() + j], literal_zncc(bev_, map_, correction), 1e-5)
            << i << " " << j << " " << yaw_rad;
      }
    }
  }
}

TEST_F(TranslationScorerTest, ScoresOneShiftOfAnyFraction) {
  ShiftPlan x;
  ShiftPlan y;
  x.set_shift(-1.23 / kGrid.cell_m);
  y.set_shift(0.71 / kGrid.cell_m);
  double score = 0.0;
  scorer_.score(0.31, x, y, {&score, 1});
  EXPECT_NEAR(score, literal_zncc(bev_, map_, {-1.23, 0.71, 0.31}), 1e-5);
}

TEST(ShiftPlanTest, SharesAPhaseAmongWholeCells) {
  const ShiftPlan plan({2.0, 0.2}, 0.6);
  ASSERT_EQ(plan.phases().size(), 3U);
  EXPECT_EQ(plan.hypotheses(), 21);
  for (const auto& phase : plan.phases()) {
    EXPECT_EQ(phase.shifts.size(), 7U);
    for (const auto& shift : phase.shifts) {
      EXPECT_NEAR((shift.cells + phase.fraction) * 0.6, (shift.hypothesis - 10) * 0.2, 1e-9);
    }
  }
}

}  // namespace
}  // namespace bevloc
