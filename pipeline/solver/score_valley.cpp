#include "pipeline/solver/score_valley.h"

#include <algorithm>

#include <Eigen/LU>

#include "pipeline/solver/gradient_sums.h"
#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

/// Added to the curvature, as a share of its trace in units of the hypotheses' deviations: where
/// the map shows nothing along an axis, that axis stays.
constexpr double kRidge = 1e-3;
/// No map shows so little; keeps H regular.
constexpr double kLeastTrace = 1e-12;

}  // namespace

ScoreValley::ScoreValley(const CellFeatures& map, const HypothesisGrid& hypotheses)
    : unit_(uniform_variance(hypotheses).cwiseSqrt()), curvature_(Eigen::Matrix3d::Zero()) {
  const BevGrid& grid = map.grid();
  // The outermost cells lack a neighbour.
  for (int row = 1; row + 1 < grid.rows; ++row) {
    const float* first = map.cell(row, 1);
    curvature_ += sum_gradients({.map = first,
                                 .moved = first,
                                 .map_row_stride = map.row_stride(),
                                 .moved_row_stride = map.row_stride(),
                                 .lanes = map.lanes(),
                                 .cells = grid.cols - 2,
                                 .cell_m = grid.cell_m,
                                 .x_m = grid.x_of_row(row),
                                 .first_y_m = grid.y_of_col(1)})
                      .curvature;
  }
}

Eigen::Matrix3d ScoreValley::curvature_at(const Se2& correction) const {
  // A turn about t is one about the middle, and a shift by (t_y, -t_x).
  Eigen::Matrix3d middle_from_here = Eigen::Matrix3d::Identity();
  middle_from_here(0, 2) = correction.y_m;
  middle_from_here(1, 2) = -correction.x_m;
  Eigen::Matrix3d curvature = middle_from_here.transpose() * curvature_ * middle_from_here;
  const double trace = std::max(unit_.cwiseAbs2().dot(curvature.diagonal()), kLeastTrace);
  curvature.diagonal() += kRidge * trace * unit_.cwiseAbs2().cwiseInverse();
  return curvature;
}

Eigen::Vector3d ScoreValley::along_x(const Se2& correction) const {
  const Eigen::Matrix3d curvature = curvature_at(correction);
  const Eigen::Vector2d others =
      -curvature.bottomRightCorner<2, 2>().inverse() * curvature.bottomLeftCorner<2, 1>();
  return {1.0, others(0), others(1)};
}

Eigen::Vector3d ScoreValley::along_yaw(const Se2& correction) const {
  const Eigen::Matrix3d curvature = curvature_at(correction);
  return {0.0, -curvature(1, 2) / curvature(1, 1), 1.0};
}

}  // namespace bevloc
