// Longitudinal and lateral position from axis features (paper, III-D, eq. 11 to 14).
#pragma once

#include <span>
#include <vector>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

/// Axis features: the mean of the features across an axis, inside a border of the largest shift.
/// The plain mean (GeM with omega = 1, eq. 12): the features are signed, which other exponents
/// cannot take. It commutes with the shift, so each side is averaged once for all hypotheses.
class AxisMatching {
 public:
  /// Means along both axes, [row, lanes] and [col, lanes], and one cell of padding.
  struct AxisFeatures {
    LaneBuffer x;
    LaneBuffer y;
  };

  AxisMatching(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses);

  /// Axis features of the map, and of the vehicle's features turned by `yaw_rad`.
  void set_features(const CellFeatures& bev, double yaw_rad, const CellFeatures& map);

  /// Mean over the channels of cov / sqrt((var + 1e-3)(var + 1e-3)) for every hypothesis.
  void score_x(std::span<double> scores) const;
  void score_y(std::span<double> scores) const;

  /// What set_features() made; the map's have mean 0 inside the border.
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
