// Scores x and y by comparing axis features (paper, III-D, eq. 11 to 14).
#pragma once

#include <span>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc {

/// Axis features are the means of the features across one axis. Cells within the largest shift of
/// the border are left out. The mean is arithmetic (GeM with omega = 1, eq. 12), because the
/// features are signed and other exponents need positive ones. It commutes with the shift, so each
/// side is averaged once for all hypotheses. The constructor allocates all memory. One thread.
class AxisMatching {
 public:
  /// Means along both axes, each with one cell of padding at the end.
  struct AxisFeatures {
    LaneBuffer x;  ///< [row, lanes]: mean over the columns
    LaneBuffer y;  ///< [col, lanes]: mean over the rows
  };

  AxisMatching(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses);

  /// Computes the axis features of the map, and of the BEV features rotated by `yaw_rad`.
  void set_features(const CellFeatures& bev, double yaw_rad, const CellFeatures& map);

  /// Per hypothesis: the mean over the channels of cov / sqrt((var + 1e-3) (var + 1e-3)).
  void score_x(std::span<double> scores) const;
  void score_y(std::span<double> scores) const;

  /// The axis features from set_features(). Those of the map have mean 0 inside the border.
  const AxisFeatures& bev() const { return bev_; }
  const AxisFeatures& map() const { return map_; }
  /// The border, in cells.
  int crop() const { return crop_; }
  int lanes() const { return lanes_; }

 private:
  void average_row(const float* cells, int row, AxisFeatures& out) const;
  void score(const LaneBuffer& bev, const LaneBuffer& map, int cells, const HypothesisAxis& axis,
             std::span<double> scores) const;

  BevGrid grid_;
  int channels_;
  int lanes_;
  int crop_;
  HypothesisGrid hypotheses_;
  AxisFeatures bev_;
  AxisFeatures map_;
  LaneBuffer warped_row_;
};

}  // namespace bevloc
