#include "pipeline/solver/cell_features.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/target_clones.h"

namespace bevloc {
namespace {

/// Cells beyond the border that a hypothesis can read: its shift, its turn, and the next cell.
int margin_of(const BevGrid& grid, const HypothesisGrid& hypotheses) {
  const double shift = std::max(hypotheses.x_m.range, hypotheses.y_m.range) / grid.cell_m + 1.0;
  const double reach = 0.5 * std::max(grid.rows, grid.cols) + shift;
  return static_cast<int>(std::ceil(shift + reach * std::sin(hypotheses.yaw_rad.range))) + 2;
}

/// The position in the source is u0 + i du, v0 + i dv from `origin`.
struct WarpLine {
  const float* origin;
  std::ptrdiff_t row_stride;
  int lanes;
  double u0;
  double v0;
  double du;
  double dv;
  int cells;
};

BEVLOC_TARGET_CLONES void warp_line(const WarpLine& line, float* out) {
  for (int i = 0; i < line.cells; ++i) {
    const double u = line.u0 + i * line.du;
    const double v = line.v0 + i * line.dv;
    const double u_floor = std::floor(u);
    const double v_floor = std::floor(v);
    const auto fu = static_cast<float>(u - u_floor);
    const auto fv = static_cast<float>(v - v_floor);
    const float w00 = (1.0F - fu) * (1.0F - fv);
    const float w01 = (1.0F - fu) * fv;
    const float w10 = fu * (1.0F - fv);
    const float w11 = fu * fv;
    const float* first = line.origin + static_cast<std::ptrdiff_t>(u_floor) * line.row_stride +
                         static_cast<std::ptrdiff_t>(v_floor) * line.lanes;
    const float* second = first + line.row_stride;
    for (int k = 0; k < line.lanes; k += kLanes) {
      lanes(out + k) = w00 * lanes(first + k) + w01 * lanes(first + line.lanes + k) +
                       w10 * lanes(second + k) + w11 * lanes(second + line.lanes + k);
    }
    out += line.lanes;
  }
}

}  // namespace

CellFeatures::CellFeatures(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses)
    : grid_(grid),
      channels_(channels),
      lanes_(round_up_to_lanes(channels)),
      margin_(margin_of(grid, hypotheses)),
      padded_cols_(grid.cols + 2 * margin_),
      data_(static_cast<size_t>(grid.rows + 2 * margin_) * padded_cols_ * lanes_) {}

void CellFeatures::assign(std::span<const float> standardised) {
  assert(standardised.size() == static_cast<size_t>(channels_) * grid_.cells());
  const float* source = standardised.data();
  for (int c = 0; c < channels_; ++c) {
    for (int row = 0; row < grid_.rows; ++row) {
      float* target = data_.data() + (cell(row, 0) - data_.data()) + c;
      for (int col = 0; col < grid_.cols; ++col) target[col * lanes_] = *source++;
    }
  }
}

void warp(const CellFeatures& features, const WarpedRow& target, float* out) {
  // Rows grow towards -x and columns towards -y, so a turn of (x, y) is the same turn of (u, v),
  // and a shift by +x reads rows further on.
  const double center_row = 0.5 * (features.grid().rows - 1);
  const double center_col = 0.5 * (features.grid().cols - 1);
  const double u = target.row - center_row + target.row_shift;
  const double v = target.col_begin - center_col + target.col_shift;
  const double cos_yaw = std::cos(target.yaw_rad);
  const double sin_yaw = std::sin(target.yaw_rad);
  warp_line({.origin = features.cell(0, 0),
             .row_stride = features.row_stride(),
             .lanes = features.lanes(),
             .u0 = cos_yaw * u + sin_yaw * v + center_row,
             .v0 = -sin_yaw * u + cos_yaw * v + center_col,
             .du = sin_yaw,
             .dv = cos_yaw,
             .cells = target.cells},
            out);
}

}  // namespace bevloc
