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
      for (int k = 0; k < line.lanes; k += kLanes) line.read(taps, i, k, lanes(out + k));
      out += line.lanes;
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

WarpLine FeatureWarp::line(int row, int col_begin, int cells) const {
  // Rows grow towards -x and columns towards -y, so a turn of (x, y) is the same turn of (u, v),
  // and a shift by +x reads rows further on.
  const double center_row = 0.5 * (features_.grid().rows - 1);
  const double center_col = 0.5 * (features_.grid().cols - 1);
  const double u = row - center_row + row_shift_;
  const double v = col_begin - center_col + col_shift_;
  return {.origin = features_.cell(0, 0),
          .row_stride = static_cast<int>(features_.row_stride()),
          .lanes = features_.lanes(),
          .u0 = cos_yaw_ * u + sin_yaw_ * v + center_row,
          .v0 = -sin_yaw_ * u + cos_yaw_ * v + center_col,
          .du = sin_yaw_,
          .dv = cos_yaw_,
          .cells = cells};
}

}  // namespace bevloc
