// Compares both ZNCC scorers with a literal implementation of ZNCC.
#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/solver/pose_scorer.h"
#include "pipeline/solver/reference/translation_scorer.h"
#include "pipeline/solver/standardise.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

constexpr BevGrid kCoarseGrid{24, 13, 0.5};
/// Hypotheses at several positions within a cell, with yaws that move features out of the grid.
constexpr HypothesisGrid kCoarseHypotheses{{1.5, 0.3}, {0.8, 0.4}, {0.4, 0.1}};

/// The moved feature at a cell: bilinear, zero outside.
double moved(const float* plane, int row, int col, const Se2& correction) {
  const Eigen::Vector2d source =
      correction.inverse() * Eigen::Vector2d(kCoarseGrid.x_of_row(row), kCoarseGrid.y_of_col(col));
  const double u = kCoarseGrid.row_of_x(source.x());
  const double v = kCoarseGrid.col_of_y(source.y());
  double sum = 0.0;
  for (int i = 0; i < kCoarseGrid.rows; ++i) {
    for (int j = 0; j < kCoarseGrid.cols; ++j) {
      const double weight =
          std::max(0.0, 1.0 - std::abs(u - i)) * std::max(0.0, 1.0 - std::abs(v - j));
      sum += weight * plane[i * kCoarseGrid.cols + j];
    }
  }
  return sum;
}

/// ZNCC over the cells of a lattice with this step and skew (CellLattice).
double literal_zncc(const std::vector<float>& bev, const std::vector<float>& map,
                    const Se2& correction, int step = 1, int skew = 0) {
  const int channels = static_cast<int>(bev.size()) / kCoarseGrid.cells();
  double sums[5] = {};
  int count = 0;
  for (int c = 0; c < channels; ++c) {
    for (int row = 0; row < kCoarseGrid.rows; ++row) {
      for (int col = skew * row % step; col < kCoarseGrid.cols; col += step) {
        const double m = map[(c * kCoarseGrid.rows + row) * kCoarseGrid.cols + col];
        const double b = moved(bev.data() + c * kCoarseGrid.cells(), row, col, correction);
        const double terms[5] = {m, b, m * m, b * b, m * b};
        for (int i = 0; i < 5; ++i) sums[i] += terms[i];
        ++count;
      }
    }
  }
  for (double& sum : sums) sum /= count;
  return (sums[4] - sums[0] * sums[1]) /
         std::sqrt((sums[2] - sums[0] * sums[0]) * (sums[3] - sums[1] * sums[1]));
}

class ZnccScorerTest : public testing::TestWithParam<int> {
 protected:
  ZnccScorerTest() {
    add_noise(bev_, 1.0F, 1);
    add_noise(map_, 1.0F, 2);
    bev_cells_.assign(bev_);
    map_cells_.assign(map_);
    EXPECT_TRUE(standardise(bev_cells_) && standardise(map_cells_));
    bev_cells_.copy_to(bev_);
    map_cells_.copy_to(map_);
  }

  std::vector<float> bev_ =
      std::vector<float>(static_cast<size_t>(GetParam()) * kCoarseGrid.cells());
  std::vector<float> map_ = bev_;
  CellFeatures bev_cells_{kCoarseGrid, GetParam(), kCoarseHypotheses};
  CellFeatures map_cells_{kCoarseGrid, GetParam(), kCoarseHypotheses};
};

TEST_P(ZnccScorerTest, TranslationScorerFollowsTheDefinition) {
  TranslationScorer scorer(kCoarseGrid, GetParam(), kCoarseHypotheses);
  scorer.set_features(bev_cells_, map_cells_);
  const ShiftPlan x(kCoarseHypotheses.x_m, kCoarseGrid.cell_m);
  const ShiftPlan y(kCoarseHypotheses.y_m, kCoarseGrid.cell_m);
  std::vector<double> scores(static_cast<size_t>(x.hypotheses()) * y.hypotheses());
  for (const double yaw_rad : {-0.4, 0.0, 0.17}) {
    scorer.score(yaw_rad, x, y, scores);
    for (int i = 0; i < x.hypotheses(); ++i) {
      for (int j = 0; j < y.hypotheses(); ++j) {
        const Se2 correction{kCoarseHypotheses.x_m.value(i), kCoarseHypotheses.y_m.value(j),
                             yaw_rad};
        EXPECT_NEAR(scores[i * y.hypotheses() + j], literal_zncc(bev_, map_, correction), 1e-5)
            << i << " " << j << " " << yaw_rad;
      }
    }
  }
}

TEST_P(ZnccScorerTest, PoseScorerFollowsTheDefinition) {
  const LatticeCells cells(map_cells_, kEveryCell);
  const PoseScorer scorer(bev_cells_, map_cells_, cells);
  for (const Se2& correction : {Se2{-1.23, 0.71, 0.31}, Se2{}, Se2{1.5, -0.8, -0.4},
                                Se2{0.5, 0.0, 0.0}, Se2{0.02, -0.33, 0.004}}) {
    EXPECT_NEAR(scorer.score(correction), literal_zncc(bev_, map_, correction), 1e-5);
  }
}

TEST_P(ZnccScorerTest, PoseScorerUsesTheCellsOfItsLattice) {
  for (const CellLattice& lattice : {kEverySecondCell, kEveryTenthCell}) {
    const LatticeCells cells(map_cells_, lattice);
    const PoseScorer scorer(bev_cells_, map_cells_, cells);
    for (const Se2& correction : {Se2{-1.23, 0.71, 0.31}, Se2{}, Se2{0.02, -0.33, 0.004}}) {
      EXPECT_NEAR(scorer.score(correction),
                  literal_zncc(bev_, map_, correction, lattice.step, lattice.skew), 1e-5)
          << "one of " << lattice.step << " cells";
    }
  }
}

// The channels fill a part of one vector, one vector, and more than one vector.
INSTANTIATE_TEST_SUITE_P(Channels, ZnccScorerTest, testing::Values(3, 16, 19));

TEST(ShiftPlanTest, GroupsShiftsThatDifferByWholeCells) {
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
