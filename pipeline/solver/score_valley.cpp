#include "pipeline/solver/score_valley.h"

#include <algorithm>

#include <Eigen/LU>

#include "pipeline/solver/gradient_sums.h"
#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

/// Share of H's trace that is added to its diagonal (both in units of the hypotheses' standard
/// deviations), so that an axis without structure in the map does not move.
constexpr double kRidge = 1e-3;
/// Lower limit of the trace, which keeps H regular. It is below the trace of any real map.
constexpr double kLeastTrace = 1e-12;

}  // namespace

ScoreValley::ScoreValley(const CellFeatures& map, const HypothesisGrid& hypotheses)
    : unit_(uniform_variance(hypotheses).cwiseSqrt()), curvature_(Eigen::Matrix3d::Zero()) {
  const BevGrid& grid = map.grid();
  // The outermost cells lack a neighbour, so they have no gradient.
  for (int row = 1; row + 1 < grid.rows; ++row) {
    const float* first = map.cell(row, 1);
    curvature_ += sum_gradients({.rows = {.map = first,
                                          .moved = first,
                                          .map_row_stride = map.row_stride(),
                                          .moved_row_stride = map.row_stride(),
                                          .lanes = map.lanes()},
                                 .cells = grid.cols - 2,
                                 .cell_m = grid.cell_m,
                                 .x_m = grid.x_of_row(row),
                                 .first_y_m = grid.y_of_col(1)})
                      .curvature;
  }
}

Eigen::Matrix3d ScoreValley::curvature_at(const Se2& correction) const {
  // A rotation about t equals one about the centre plus a shift by (t_y, -t_x).
  Eigen::Matrix3d center_from_here = Eigen::Matrix3d::Identity();
  center_from_here(0, 2) = correction.y_m;
  center_from_here(1, 2) = -correction.x_m;
  Eigen::Matrix3d curvature = center_from_here.transpose() * curvature_ * center_from_here;
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
