#include "pipeline/solver/match_covariance.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

constexpr double kBlock_m = 6.0;
/// Keeps S regular. Per cell, in squared gradients of standardised features (1/m^2): far below any
/// gradient that could be evidence.
constexpr double kSlopeFloor = 1e-6;

}  // namespace

MatchCovariance::MatchCovariance(const BevGrid& grid, int channels,
                                 const HypothesisGrid& hypotheses)
    : grid_(grid),
      lanes_(round_up_to_lanes(channels)),
      border_(static_cast<int>(std::max(hypotheses.x_m.range, hypotheses.y_m.range) / grid.cell_m) +
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
  const Eigen::Matrix3d evidence = curvature * slope.inverse() * curvature;
  // In units of the prior's deviations the sum is well conditioned.
  const Eigen::Vector3d unit = uniform_variance_.cwiseSqrt();
  const Eigen::Matrix3d scaled = unit.asDiagonal() * evidence * unit.asDiagonal();
  const Eigen::Matrix3d posterior =
      (0.5 * (scaled + scaled.transpose()) + Eigen::Matrix3d::Identity()).inverse();
  return unit.asDiagonal() * posterior * unit.asDiagonal();
}

void MatchCovariance::add_block(const CellFeatures& map, const Se2& correction, int first_row,
                                int first_col, Information& information) const {
  const int block = std::max(1, static_cast<int>(kBlock_m / grid_.cell_m));
  const int row_end = std::min(first_row + block, grid_.rows - border_);
  const int col_end = std::min(first_col + block, grid_.cols - border_);
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  for (int row = first_row; row < row_end; ++row) {
    for (int col = first_col; col < col_end; ++col) {
      const CellSums sums = cell_sums(map, row, col);
      // The turn is about the vehicle's corrected position: it moves p along (-y, x).
      Eigen::Matrix<double, 2, 3> point_by_pose;
      point_by_pose << 1.0, 0.0, -(grid_.y_of_col(col) - correction.y_m),  //
          0.0, 1.0, grid_.x_of_row(row) - correction.x_m;
      Eigen::Matrix2d products;
      products << sums.xx, sums.xy, sums.yx, sums.yy;
      information.curvature += point_by_pose.transpose() * products * point_by_pose;
      slope += point_by_pose.transpose() * Eigen::Vector2d(sums.x_residual, sums.y_residual);
    }
  }
  information.slope += slope * slope.transpose();
}

/// Gradients are central differences; rows and columns run against x and y.
MatchCovariance::CellSums MatchCovariance::cell_sums(const CellFeatures& map, int row,
                                                     int col) const {
  const std::ptrdiff_t map_row = map.row_stride();
  const std::ptrdiff_t moved_row = static_cast<std::ptrdiff_t>(grid_.cols) * lanes_;
  const float* m = map.cell(row, col);
  const float* b = moved_.data() + row * moved_row + col * lanes_;
  Lanes sums[6] = {};
  for (int k = 0; k < lanes_; k += kLanes) {
    const Lanes map_x = lanes(m + k - map_row) - lanes(m + k + map_row);
    const Lanes map_y = lanes(m + k - lanes_) - lanes(m + k + lanes_);
    const Lanes bev_x = lanes(b + k - moved_row) - lanes(b + k + moved_row);
    const Lanes bev_y = lanes(b + k - lanes_) - lanes(b + k + lanes_);
    const Lanes residual = lanes(m + k) - lanes(b + k);
    sums[0] += map_x * bev_x;
    sums[1] += map_x * bev_y;
    sums[2] += map_y * bev_x;
    sums[3] += map_y * bev_y;
    sums[4] += map_x * residual;
    sums[5] += map_y * residual;
  }
  const double per_m = 1.0 / (2.0 * grid_.cell_m);
  return {per_m * per_m * sum_of(sums[0]), per_m * per_m * sum_of(sums[1]),
          per_m * per_m * sum_of(sums[2]), per_m * per_m * sum_of(sums[3]),
          per_m * sum_of(sums[4]),         per_m * sum_of(sums[5])};
}

}  // namespace bevloc
