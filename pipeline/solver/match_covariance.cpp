#include "pipeline/solver/match_covariance.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "common/target_clones.h"
#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

constexpr double kBlock_m = 6.0;
/// Keeps S regular. Per cell, in squared gradients of standardised features (1/m^2): far below any
/// gradient that could be evidence.
constexpr double kSlopeFloor = 1e-6;
/// Against the prior's, in any direction: deviations of 0.001 of the prior's, far below a step.
/// More of it in one direction would drown what is known of the others in rounding.
constexpr double kMostEvidence = 1e6;

/// Neighbouring cells of a row of both sides.
struct RowSegment {
  const float* map;
  const float* moved;
  std::ptrdiff_t map_row_stride;
  std::ptrdiff_t moved_row_stride;
  int lanes;
  int cells;
  float first_lever;  ///< the first cell's -y: what a turn moves it along x, per radian
  float lever_step;
};

/// Sums over a segment's cells and channels: products of the gradients of map and vehicle (map's
/// first), and of the map's gradients with the residual; then the same weighted by the lever.
struct SegmentSums {
  float xx, xy, yx, yy, x_residual, y_residual;
  float lever_xx, lever_xy, lever_yx, lever_x_residual;
  float lever2_xx;
};

/// Gradients are differences over two cells; rows and columns run against x and y.
BEVLOC_TARGET_CLONES SegmentSums sum_segment(const RowSegment& s) {
  Lanes xx = {}, xy = {}, yx = {}, yy = {}, x_residual = {}, y_residual = {};
  Lanes lever_xx = {}, lever_xy = {}, lever_yx = {}, lever_x_residual = {}, lever2_xx = {};
  for (int i = 0; i < s.cells; ++i) {
    const float lever = s.first_lever + static_cast<float>(i) * s.lever_step;
    for (int k = 0; k < s.lanes; k += kLanes) {
      const float* m = s.map + i * s.lanes + k;
      const float* b = s.moved + i * s.lanes + k;
      const Lanes map_x = lanes(m - s.map_row_stride) - lanes(m + s.map_row_stride);
      const Lanes map_y = lanes(m - s.lanes) - lanes(m + s.lanes);
      const Lanes bev_x = lanes(b - s.moved_row_stride) - lanes(b + s.moved_row_stride);
      const Lanes bev_y = lanes(b - s.lanes) - lanes(b + s.lanes);
      const Lanes residual = lanes(m) - lanes(b);
      const Lanes product_xx = map_x * bev_x;
      const Lanes lever_map_x = lever * map_x;
      xx += product_xx;
      xy += map_x * bev_y;
      yx += map_y * bev_x;
      yy += map_y * bev_y;
      x_residual += map_x * residual;
      y_residual += map_y * residual;
      lever_xx += lever * product_xx;
      lever_xy += lever_map_x * bev_y;
      lever_yx += lever * (map_y * bev_x);
      lever_x_residual += lever_map_x * residual;
      lever2_xx += lever * (lever * product_xx);
    }
  }
  return {sum_of(xx),         sum_of(xy),
          sum_of(yx),         sum_of(yy),
          sum_of(x_residual), sum_of(y_residual),
          sum_of(lever_xx),   sum_of(lever_xy),
          sum_of(lever_yx),   sum_of(lever_x_residual),
          sum_of(lever2_xx)};
}

}  // namespace

MatchCovariance::MatchCovariance(const BevGrid& grid, int channels,
                                 const HypothesisGrid& hypotheses)
    : grid_(grid),
      lanes_(round_up_to_lanes(channels)),
      border_(static_cast<int>(std::max(hypotheses.x_m.farthest(), hypotheses.y_m.farthest()) /
                               grid.cell_m) +
              2),
      uniform_variance_(uniform_variance(hypotheses)),
      moved_(static_cast<size_t>(grid.cells()) * lanes_) {}

Eigen::Matrix3d MatchCovariance::estimate(const CellFeatures& bev, const CellFeatures& map,
                                          const Se2& correction) {
  WarpedRow target{.yaw_rad = correction.yaw_rad,
                   .row_shift = correction.x_m / grid_.cell_m,
                   .col_shift = correction.y_m / grid_.cell_m,
                   .cells = grid_.cols};
  for (target.row = 0; target.row < grid_.rows; ++target.row) {
    warp(bev, target, moved_.data() + target.row * grid_.cols * lanes_);
  }
  const int block = std::max(1, static_cast<int>(kBlock_m / grid_.cell_m));
  Information information;
  for (int row = border_; row < grid_.rows - border_; row += block) {
    for (int col = border_; col < grid_.cols - border_; col += block) {
      add_block(map, correction, row, col, information);
    }
  }
  const Eigen::Matrix3d curvature =
      0.5 * (information.curvature + information.curvature.transpose());
  const Eigen::Matrix3d slope =
      information.slope + kSlopeFloor * grid_.cells() * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d evidence = curvature * slope.ldlt().solve(curvature);
  // In units of the prior's deviations the sum is well conditioned.
  const Eigen::Vector3d unit = uniform_variance_.cwiseSqrt();
  const Eigen::Matrix3d scaled = unit.asDiagonal() * evidence * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(0.5 *
                                                                  (scaled + scaled.transpose()));
  const Eigen::Vector3d variance =
      (directions.eigenvalues().cwiseMax(0.0).cwiseMin(kMostEvidence).array() + 1.0).inverse();
  const Eigen::Matrix3d posterior =
      directions.eigenvectors() * variance.asDiagonal() * directions.eigenvectors().transpose();
  return unit.asDiagonal() * posterior * unit.asDiagonal();
}

void MatchCovariance::add_block(const CellFeatures& map, const Se2& correction, int first_row,
                                int first_col, Information& information) const {
  const int block = std::max(1, static_cast<int>(kBlock_m / grid_.cell_m));
  const int row_end = std::min(first_row + block, grid_.rows - border_);
  const int col_end = std::min(first_col + block, grid_.cols - border_);
  // Of differences over two cells.
  const double per_m = 1.0 / (2.0 * grid_.cell_m);
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  for (int row = first_row; row < row_end; ++row) {
    // The turn is about the vehicle's corrected position: it moves p along (-y, x).
    const std::ptrdiff_t moved_row = static_cast<std::ptrdiff_t>(grid_.cols) * lanes_;
    const SegmentSums s =
        sum_segment({.map = map.cell(row, first_col),
                     .moved = moved_.data() + row * moved_row + first_col * lanes_,
                     .map_row_stride = map.row_stride(),
                     .moved_row_stride = moved_row,
                     .lanes = lanes_,
                     .cells = col_end - first_col,
                     .first_lever = static_cast<float>(correction.y_m - grid_.y_of_col(first_col)),
                     .lever_step = static_cast<float>(grid_.cell_m)});
    const double along = grid_.x_of_row(row) - correction.x_m;
    Eigen::Matrix3d curvature;
    curvature << s.xx, s.xy, s.lever_xx + along * s.xy,  //
        s.yx, s.yy, s.lever_yx + along * s.yy,           //
        s.lever_xx + along * s.yx, s.lever_xy + along * s.yy,
        s.lever2_xx + along * (s.lever_xy + s.lever_yx) + along * along * s.yy;
    information.curvature += per_m * per_m * curvature;
    slope += per_m *
             Eigen::Vector3d(s.x_residual, s.y_residual, s.lever_x_residual + along * s.y_residual);
  }
  information.slope += slope * slope.transpose();
}

}  // namespace bevloc
