// What one match says about the errors of the cameras' extrinsics.
#pragma once

#include "common/se2.h"
#include "pipeline/network/view/view_table.h"
#include "pipeline/online_calibration/extrinsic_errors.h"
#include "pipeline/solver/cell_features.h"

namespace bevloc {

/// Sums over the cells that one camera sees, weighted with its share.
struct SeenByCamera {
  double product = 0.0;  ///< product of the features of both sides
  double map_square = 0.0;
  double bev_square = 0.0;
};

/// Information about the errors: near the extrinsics that were used, the score of the match falls
/// like (e - information^-1 slope)' information (e - ...) / 2.
struct ExtrinsicInformation {
  ExtrinsicCovariance information = ExtrinsicCovariance::Zero();
  ExtrinsicErrors slope = ExtrinsicErrors::Zero();
  std::array<SeenByCamera, kCameraCount> seen{};
};

/// The features of one match.
struct MatchedCells {
  /// Standardised BEV features, moved by `correction`: [row, col, lanes] on the grid of `map`.
  const LaneBuffer& moved;
  const CellFeatures& map;  ///< standardised
  const ViewTable& view;    ///< the table that the BEV features were computed with
  const Rig& rig;           ///< the network rig that `view` was computed with
  Se2 correction;           ///< correction that aligns the BEV features with `map`
};

/// Compares the positions of the lines that each camera sees with their positions in the map.
///
/// If a camera has an error e, its features at the ground point p are shifted by D(p) e
/// (ground_shift()), so F_B(p) = a(p) F_M(p + D e), with a(p) < 1 because far features fade. The
/// slope of the score is computed as D' (F_B grad F_M - F_M grad F_B) / 2. In this difference, the
/// terms of F_M alone cancel, and only the gradient of a(p) remains. (Least squares of F_M - F_B
/// instead showed 0.6 degrees of pitch where there was no error.)
/// The information uses only the gradients of the map, because the gradients of misplaced features
/// coincide with the true ones by chance.
///
/// The equations also contain the correction of the match, which is eliminated. A match therefore
/// does not show camera errors whose effect equals a shift or a turn of the vehicle.
///
/// Allocates nothing. One thread.
class ExtrinsicSums {
 public:
  explicit ExtrinsicSums(const BevGrid& grid) : grid_(grid) {}

  /// The result is all zero, so that nothing is learned, if the features do not determine the
  /// correction.
  void compute(const MatchedCells& match, ExtrinsicInformation& result);

 private:
  static constexpr int kPose = 3;
  static constexpr int kUnknowns = kPose + kExtrinsicErrors;
  using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  using Vector = Eigen::Matrix<double, kUnknowns, 1>;

  /// The cameras that see a cell (kViewSlots).
  static constexpr int kMostCameras = 2;
  static constexpr int kMostOfBlock = kPose + kMostCameras * kErrorsPerCamera;

  /// How cameras see a block of cells.
  struct BlockView {
    /// Shift of what the block shows, per unit of the pose and of the errors of its cameras.
    Eigen::Matrix<double, 2, kMostOfBlock> shift = Eigen::Matrix<double, 2, kMostOfBlock>::Zero();
    std::array<int, kMostCameras> seen_by{};
    std::array<double, kMostCameras> shares{};
    int cameras = 0;
    /// Square root of the weights along and across the rays of sight, in the frame of the prior.
    Eigen::Matrix2d weight_root = Eigen::Matrix2d::Zero();
    /// Square root of the network's response to errors, along the same axes.
    Eigen::Matrix2d response_root = Eigen::Matrix2d::Zero();
    double near_weight = 0.0;  ///< weight in the agreement with the map
  };

  BlockView view_block(const MatchedCells& match, int first_row, int first_col) const;
  void add_equations(const BlockView& view, const Eigen::Matrix2d& curvature,
                     const Eigen::Vector2d& slope);
  void add_block(const MatchedCells& match, int first_row, int first_col,
                 std::array<SeenByCamera, kCameraCount>& seen);
  void eliminate_pose(ExtrinsicInformation& result) const;

  BevGrid grid_;
  Matrix information_;
  Vector slope_;
};

}  // namespace bevloc
