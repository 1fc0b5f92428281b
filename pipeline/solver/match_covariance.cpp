#include "pipeline/solver/match_covariance.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "pipeline/solver/cell_rows.h"
#include "pipeline/solver/feature_warp.h"
#include "pipeline/solver/gradient_sums.h"
#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

constexpr double kBlock_m = 6.0;
/// Keeps S regular. It is a squared gradient of standardised features per cell (1/m^2), far below
/// the gradient of any structure.
constexpr double kSlopeFloor = 1e-6;
/// Limit of the match's information relative to the prior's, along any direction. It corresponds to
/// 0.001 of the prior's standard deviation, far below a step. More information along one direction
/// would lose that of the others to rounding.
constexpr double kMaxInformation = 1e6;

}  // namespace

MatchCovariance::MatchCovariance(const BevGrid& grid, int channels,
                                 const HypothesisGrid& hypotheses)
    : grid_(grid),
      border_(static_cast<int>(std::max(hypotheses.x_m.farthest(), hypotheses.y_m.farthest()) /
                               grid.cell_m) +
              2),
      uniform_variance_(uniform_variance(hypotheses)),
      moved_(static_cast<size_t>(grid.cells()) * round_up_to_lanes(channels)) {}

Eigen::Matrix3d MatchCovariance::estimate(const CellFeatures& bev, const CellFeatures& map,
                                          const Se2& correction) {
  warp_all(bev, correction, moved_.data(), grid_.cols * bev.lanes());
  const int block = std::max(1, static_cast<int>(kBlock_m / grid_.cell_m));
  Information information;
  int blocks = 0;
  for (int row = border_; row < grid_.rows - border_; row += block) {
    for (int col = border_; col < grid_.cols - border_; col += block) {
      add_block(map, correction, row, col, information);
      ++blocks;
    }
  }
  const Eigen::Matrix3d curvature =
      0.5 * (information.curvature + information.curvature.transpose());
  const Eigen::Matrix3d slope =
      information.slope + kSlopeFloor * grid_.cells() * Eigen::Matrix3d::Identity();
  // S from few blocks is too small by chance along some direction (Hotelling): on average, S^-1 of
  // n blocks in three dimensions is n / (n - 4) times too large.
  const double trust = std::max(0.0, 1.0 - 4.0 / std::max(blocks, 1));
  const Eigen::Matrix3d match = trust * curvature * slope.ldlt().solve(curvature);
  // In units of the prior's standard deviations the sum is well conditioned.
  const Eigen::Vector3d unit = uniform_variance_.cwiseSqrt();
  const Eigen::Matrix3d scaled = unit.asDiagonal() * match * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(0.5 *
                                                                  (scaled + scaled.transpose()));
  const Eigen::Vector3d variance =
      (directions.eigenvalues().cwiseMax(0.0).cwiseMin(kMaxInformation).array() + 1.0).inverse();
  const Eigen::Matrix3d posterior =
      directions.eigenvectors() * variance.asDiagonal() * directions.eigenvectors().transpose();
  return unit.asDiagonal() * posterior * unit.asDiagonal();
}

void MatchCovariance::add_block(const CellFeatures& map, const Se2& correction, int first_row,
                                int first_col, Information& information) const {
  const int block = std::max(1, static_cast<int>(kBlock_m / grid_.cell_m));
  const int row_end = std::min(first_row + block, grid_.rows - border_);
  const int col_end = std::min(first_col + block, grid_.cols - border_);
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  for (int row = first_row; row < row_end; ++row) {
    const GradientSums sums =
        sum_gradients({.rows = rows_at(map, moved_, row, first_col),
                       .cells = col_end - first_col,
                       .cell_m = grid_.cell_m,
                       .x_m = grid_.x_of_row(row) - correction.x_m,
                       .first_y_m = grid_.y_of_col(first_col) - correction.y_m});
    information.curvature += sums.curvature;
    slope += sums.slope;
  }
  information.slope += slope * slope.transpose();
}

}  // namespace bevloc
