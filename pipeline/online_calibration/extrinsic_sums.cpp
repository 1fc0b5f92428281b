#include "pipeline/online_calibration/extrinsic_sums.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "common/target_clones.h"
#include "pipeline/solver/cell_rows.h"

namespace bevloc {
namespace {

/// Cells of a block along each axis. Shares and shifts are computed once per block.
constexpr int kBlockCells = 3;
/// Cells at each edge of the grid that are not used.
constexpr int kBorderCells = 2;
/// A block is used only if the shares of all cameras sum to at least this, because cells that no
/// camera sees carry no features.
constexpr double kLeastShare = 0.99;
/// The weight along the ray of sight falls to 0 at this distance from the camera. A pitch error
/// moves a point at distance d by the error times d^2 / height: by 0.9 m for 0.3 degrees at 16 m,
/// about the width of a line in the features. Beyond this distance, perceived and mapped lines no
/// longer overlap, so the slope says nothing.
constexpr double kReach_m = 16.0;
/// The weight across the ray of sight falls to 0 at this distance. Only yaw and roll errors of the
/// camera move a point in this direction: by 0.2 m for 0.3 degrees at 40 m.
constexpr double kReachAcross_m = 40.0;
/// If the network was trained with calibration errors, its features move by less than the full
/// shift that an error causes: by these shares of it, along and across the ray of sight.
constexpr double kResponseAlong = 0.4;
constexpr double kResponseAcross = 0.9;
/// Least ratio of perceived to mapped features. Below it there is nothing to learn from.
constexpr double kLeastStrength = 0.05;

/// Sums over the cells of a block and all channels.
struct BlockSums {
  float xx = 0.0F;  ///< products of the map's gradients
  float xy = 0.0F;
  float yy = 0.0F;
  float slope_x = 0.0F;
  float slope_y = 0.0F;
  float product = 0.0F;  ///< products of both sides
  float map_square = 0.0F;
  float moved_square = 0.0F;
};

/// `block` are both sides at the first cell of the block.
BEVLOC_TARGET_CLONES BlockSums sum_block(const CellRows& block) {
  Lanes xx = {}, xy = {}, yy = {}, slope_x = {}, slope_y = {};
  Lanes product = {}, map_square = {}, moved_square = {};
  for (int row = 0; row < kBlockCells; ++row) {
    for (int i = 0; i < kBlockCells * block.lanes; i += kLanes) {
      const float* m = block.map + row * block.map_row_stride + i;
      const float* b = block.moved + row * block.moved_row_stride + i;
      const Slope map_slope = slope_at(m, block.map_row_stride, block.lanes);
      const Slope moved_slope = slope_at(b, block.moved_row_stride, block.lanes);
      const Lanes& map = lanes(m);
      const Lanes& moved = lanes(b);
      xx += map_slope.x * map_slope.x;
      xy += map_slope.x * map_slope.y;
      yy += map_slope.y * map_slope.y;
      slope_x += moved * map_slope.x - map * moved_slope.x;
      slope_y += moved * map_slope.y - map * moved_slope.y;
      product += map * moved;
      map_square += map * map;
      moved_square += moved * moved;
    }
  }
  return {sum_of(xx),      sum_of(xy),      sum_of(yy),         sum_of(slope_x),
          sum_of(slope_y), sum_of(product), sum_of(map_square), sum_of(moved_square)};
}

/// The share of each camera in the cells of a block.
std::array<double, kCameraCount> shares_of(const ViewTable& view, const BevGrid& grid,
                                           int first_row, int first_col) {
  std::array<double, kCameraCount> shares{};
  const auto cells = static_cast<size_t>(grid.cells());
  for (int row = first_row; row < first_row + kBlockCells; ++row) {
    for (int col = first_col; col < first_col + kBlockCells; ++col) {
      const size_t cell = static_cast<size_t>(row) * grid.cols + col;
      for (size_t slot = 0; slot < kViewSlots; ++slot) {
        const size_t entry = slot * cells + cell;
        shares[static_cast<size_t>(view.index[entry] / kImageFeatureCells)] += view.weight[entry];
      }
    }
  }
  for (double& share : shares) share /= kBlockCells * kBlockCells;
  return shares;
}

/// How a point of the ground counts for a camera: symmetric matrices whose axes lie along and
/// across the ray of sight.
struct PointWeight {
  Eigen::Matrix2d root;           ///< square root of the weights
  Eigen::Matrix2d response_root;  ///< square root of the network's response
};

PointWeight weight_of(const Se3& vehicle_from_camera, const Eigen::Vector2d& point) {
  const Eigen::Vector2d ray = point - vehicle_from_camera.translation_m.head<2>();
  const double distance_m = ray.norm();
  const auto root = [distance_m](double reach_m) {
    return std::sqrt(std::max(0.0, 1.0 - distance_m * distance_m / (reach_m * reach_m)));
  };
  const Eigen::Vector2d ahead = ray / std::max(distance_m, 1e-6);
  const auto with_axes = [&ahead](double along, double across) -> Eigen::Matrix2d {
    return across * Eigen::Matrix2d::Identity() + (along - across) * ahead * ahead.transpose();
  };
  return {with_axes(root(kReach_m), root(kReachAcross_m)),
          with_axes(std::sqrt(kResponseAlong), std::sqrt(kResponseAcross))};
}

/// The weight of a point for the agreement of the camera with the map.
double near_weight_of(const Se3& vehicle_from_camera, const Eigen::Vector2d& point) {
  const Eigen::Vector2d ray = point - vehicle_from_camera.translation_m.head<2>();
  return std::max(0.0, 1.0 - ray.squaredNorm() / (kReach_m * kReach_m));
}

}  // namespace

void ExtrinsicSums::compute(const MatchedCells& match, ExtrinsicInformation& result) {
  assert(match.moved.size() == static_cast<size_t>(grid_.cells()) * match.map.lanes());
  result.information.setZero();
  result.slope.setZero();
  information_.setZero();
  slope_.setZero();
  result.seen = {};
  for (int row = kBorderCells; row + kBlockCells + kBorderCells <= grid_.rows; row += kBlockCells) {
    for (int col = kBorderCells; col + kBlockCells + kBorderCells <= grid_.cols;
         col += kBlockCells) {
      add_block(match, row, col, result.seen);
    }
  }
  double product = 0.0;
  double square = 0.0;
  for (const SeenByCamera& seen : result.seen) {
    product += seen.product;
    square += seen.map_square;
  }
  const double strength = square > 0.0 ? product / square : 0.0;
  if (!(strength > kLeastStrength)) return;
  information_ *= strength;
  eliminate_pose(result);
}

void ExtrinsicSums::add_block(const MatchedCells& match, int first_row, int first_col,
                              std::array<SeenByCamera, kCameraCount>& seen) {
  const BlockView view = view_block(match, first_row, first_col);
  if (view.cameras == 0) return;
  const BlockSums sums = sum_block(rows_at(match.map, match.moved, first_row, first_col));
  for (int part = 0; part < view.cameras; ++part) {
    const double weight = view.near_weight * view.shares[part];
    SeenByCamera& sum = seen[view.seen_by[part]];
    sum.product += weight * sums.product;
    sum.map_square += weight * sums.map_square;
    sum.bev_square += weight * sums.moved_square;
  }
  // Central differences span two cells; the slope is half a difference of two gradients.
  const double per_m = 1.0 / (2.0 * grid_.cell_m);
  Eigen::Matrix2d curvature;
  curvature << sums.xx, sums.xy, sums.xy, sums.yy;
  const Eigen::Matrix2d root = per_m * view.response_root * view.weight_root;
  add_equations(view, root * curvature * root.transpose(),
                0.5 * per_m * view.weight_root * view.weight_root *
                    Eigen::Vector2d(sums.slope_x, sums.slope_y));
}

ExtrinsicSums::BlockView ExtrinsicSums::view_block(const MatchedCells& match, int first_row,
                                                   int first_col) const {
  const auto shares = shares_of(match.view, grid_, first_row, first_col);
  BlockView view;
  double covered = 0.0;
  for (const double share : shares) covered += share;
  if (covered < kLeastShare) return view;

  // The middle of the block, in the frames of the prior and of the vehicle.
  const double middle = 0.5 * (kBlockCells - 1);
  const Eigen::Vector2d prior_point(grid_.x_of_row(first_row + middle),
                                    grid_.y_of_col(first_col + middle));
  const Eigen::Vector2d point = match.correction.inverse() * prior_point;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(match.correction.yaw_rad).toRotationMatrix();

  view.shift.leftCols<2>().setIdentity();
  view.shift.col(2) << match.correction.y_m - prior_point.y(),
      prior_point.x() - match.correction.x_m;
  for (int camera = 0; camera < kCameraCount && view.cameras < kMostCameras; ++camera) {
    if (shares[camera] < 1.0 - kLeastShare) continue;
    const Se3& extrinsics = match.rig.cameras[camera].vehicle_from_camera;
    view.shift.middleCols<kErrorsPerCamera>(kPose + view.cameras * kErrorsPerCamera) =
        shares[camera] * turn * ground_shift(extrinsics, point.x(), point.y());
    view.shares[view.cameras] = shares[camera];
    view.seen_by[view.cameras++] = camera;
    const PointWeight weight = weight_of(extrinsics, point);
    view.weight_root += shares[camera] * turn * weight.root * turn.transpose();
    view.response_root += shares[camera] * turn * weight.response_root * turn.transpose();
    view.near_weight += shares[camera] * near_weight_of(extrinsics, point);
  }
  return view;
}

void ExtrinsicSums::add_equations(const BlockView& view, const Eigen::Matrix2d& curvature,
                                  const Eigen::Vector2d& slope) {
  const Eigen::Matrix<double, kMostOfBlock, kMostOfBlock> information =
      view.shift.transpose() * curvature * view.shift;
  const Eigen::Matrix<double, kMostOfBlock, 1> by_unknown = view.shift.transpose() * slope;
  // Part 0 is the pose, the others are the cameras.
  const auto place = [&view](int part) {
    return part == 0 ? 0 : kPose + view.seen_by[part - 1] * kErrorsPerCamera;
  };
  const auto first = [](int part) { return part == 0 ? 0 : kPose + (part - 1) * kErrorsPerCamera; };
  const auto size = [](int part) { return part == 0 ? kPose : kErrorsPerCamera; };
  for (int i = 0; i <= view.cameras; ++i) {
    slope_.segment(place(i), size(i)) += by_unknown.segment(first(i), size(i));
    for (int j = 0; j <= view.cameras; ++j) {
      information_.block(place(i), place(j), size(i), size(j)) +=
          information.block(first(i), first(j), size(i), size(j));
    }
  }
}

void ExtrinsicSums::eliminate_pose(ExtrinsicInformation& result) const {
  const Eigen::Matrix3d pose = information_.topLeftCorner<kPose, kPose>();
  const Eigen::LLT<Eigen::Matrix3d> solver(pose);
  if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-9)) return;
  const Eigen::Matrix<double, kPose, kExtrinsicErrors> mixed =
      information_.topRightCorner<kPose, kExtrinsicErrors>();
  const Eigen::Matrix<double, kPose, kExtrinsicErrors> solved = solver.solve(mixed);
  result.information = information_.bottomRightCorner<kExtrinsicErrors, kExtrinsicErrors>();
  result.information.noalias() -= mixed.transpose() * solved;
  result.slope = slope_.tail<kExtrinsicErrors>() - solved.transpose() * slope_.head<kPose>();
}

}  // namespace bevloc
