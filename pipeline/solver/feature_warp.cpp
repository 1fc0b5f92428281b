#include "pipeline/solver/feature_warp.h"

#include <algorithm>

#include "common/target_clones.h"

namespace bevloc {

BEVLOC_TARGET_CLONES void warp(const WarpLine& line, float* out) {
  TapGroups groups(line);
  for (int first = 0; first < line.cells; first += kLanes) {
    const Taps& taps = groups.next();
    const int count = std::min(kLanes, line.cells - first);
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < line.source.lanes; k += kLanes) {
        line.source.read(taps, i, k, lanes(out + k));
      }
      out += line.source.lanes;
    }
  }
}

FeatureWarp::FeatureWarp(const CellFeatures& features, double yaw_rad, double row_shift,
                         double col_shift)
    : features_(features),
      cos_yaw_(std::cos(yaw_rad)),
      sin_yaw_(std::sin(yaw_rad)),
      row_shift_(row_shift),
      col_shift_(col_shift) {}

FeatureWarp::FeatureWarp(const CellFeatures& features, const Se2& correction)
    : FeatureWarp(features, correction.yaw_rad, correction.x_m / features.grid().cell_m,
                  correction.y_m / features.grid().cell_m) {}

void warp_all(const CellFeatures& features, const Se2& correction, float* out,
              std::ptrdiff_t row_stride) {
  const FeatureWarp moved(features, correction);
  const BevGrid& grid = features.grid();
  for (int row = 0; row < grid.rows; ++row) {
    warp(moved.line(row, 0, grid.cols), out + row * row_stride);
  }
}

}  // namespace bevloc
