#include "pipeline/solver/cell_features.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/target_clones.h"

namespace bevloc {
namespace {

/// Cells beyond the border that a hypothesis can read, by its shift, rotation and interpolation.
int margin_of(const BevGrid& grid, const HypothesisGrid& hypotheses) {
  const double shift =
      std::max(hypotheses.x_m.farthest(), hypotheses.y_m.farthest()) / grid.cell_m + 1.0;
  const double reach = 0.5 * std::max(grid.rows, grid.cols) + shift;
  return static_cast<int>(std::ceil(shift + reach * std::sin(hypotheses.yaw_rad.farthest()))) + 2;
}

/// One step of a matrix transpose: exchanges blocks of `step` values between two rows that are
/// `step` rows apart.
template <int step>
inline void exchange(Lanes& upper, Lanes& lower) {
  LaneIntegers to_upper{};
  LaneIntegers to_lower{};
  for (int k = 0; k < kLanes; ++k) {
    to_upper[k] = (k & step) != 0 ? kLanes + k - step : k;
    to_lower[k] = (k & step) != 0 ? kLanes + k : k + step;
  }
  const Lanes old_upper = upper;
  upper = __builtin_shuffle(old_upper, lower, to_upper);
  lower = __builtin_shuffle(old_upper, lower, to_lower);
}

template <int step>
inline void exchange_rows(Lanes* rows) {
  for (int i = 0; i < kLanes; ++i) {
    if ((i & step) == 0) exchange<step>(rows[i], rows[i + step]);
  }
}

/// Transposes kLanes channels of a row of cells to [cell, channel]. In the source, channels are
/// `channel_step` floats apart.
BEVLOC_TARGET_CLONES void interleave(const float* row, std::ptrdiff_t channel_step, int cells,
                                     int lane_count, float* out) {
  int i = 0;
  for (; i + kLanes <= cells; i += kLanes) {
    Lanes block[kLanes];
    for (int c = 0; c < kLanes; ++c) block[c] = lanes(row + c * channel_step + i);
    exchange_rows<8>(block);
    exchange_rows<4>(block);
    exchange_rows<2>(block);
    exchange_rows<1>(block);
    for (int k = 0; k < kLanes; ++k) lanes(out + (i + k) * lane_count) = block[k];
  }
  for (; i < cells; ++i) {
    for (int c = 0; c < kLanes; ++c) out[i * lane_count + c] = row[c * channel_step + i];
  }
}

/// Does the same for fewer than kLanes channels.
void interleave_few(const float* row, std::ptrdiff_t channel_step, int channels, int cells,
                    int lane_count, float* out) {
  for (int i = 0; i < cells; ++i) {
    for (int c = 0; c < channels; ++c) out[i * lane_count + c] = row[c * channel_step + i];
  }
}

BEVLOC_TARGET_CLONES void average_block(const float* first, std::ptrdiff_t row_stride, int size,
                                        int lane_count, float* out) {
  const float weight = 1.0F / static_cast<float>(size * size);
  for (int k = 0; k < lane_count; k += kLanes) {
    Lanes sum = {};
    for (int row = 0; row < size; ++row) {
      for (int col = 0; col < size; ++col) {
        sum += lanes(first + row * row_stride + col * lane_count + k);
      }
    }
    lanes(out + k) = weight * sum;
  }
}

}  // namespace

CellFeatures::CellFeatures(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses)
    : CellFeatures(grid, channels, margin_of(grid, hypotheses)) {}

CellFeatures::CellFeatures(const BevGrid& grid, int channels) : CellFeatures(grid, channels, 0) {}

CellFeatures::CellFeatures(const BevGrid& grid, int channels, int margin)
    : grid_(grid),
      channels_(channels),
      lanes_(round_up_to_lanes(channels)),
      margin_(margin),
      padded_cols_(grid.cols + 2 * margin_),
      data_(static_cast<size_t>(grid.rows + 2 * margin_) * padded_cols_ * lanes_) {}

void CellFeatures::assign(std::span<const float> planes) {
  assert(planes.size() == static_cast<size_t>(channels_) * grid_.cells());
  for (int row = 0; row < grid_.rows; ++row) {
    const float* source = planes.data() + static_cast<size_t>(row) * grid_.cols;
    float* target = mutable_cell(row, 0);
    int c = 0;
    for (; c + kLanes <= channels_; c += kLanes) {
      interleave(source + static_cast<std::ptrdiff_t>(c) * grid_.cells(), grid_.cells(), grid_.cols,
                 lanes_, target + c);
    }
    interleave_few(source + static_cast<std::ptrdiff_t>(c) * grid_.cells(), grid_.cells(),
                   channels_ - c, grid_.cols, lanes_, target + c);
  }
}

void CellFeatures::copy_to(std::span<float> planes) const {
  assert(planes.size() == static_cast<size_t>(channels_) * grid_.cells());
  for (int c = 0; c < channels_; ++c) {
    float* target = planes.data() + static_cast<size_t>(c) * grid_.cells();
    for (int row = 0; row < grid_.rows; ++row) {
      const float* source = cell(row, 0) + c;
      for (int col = 0; col < grid_.cols; ++col) *target++ = source[col * lanes_];
    }
  }
}

void CellFeatures::assign_average_of(const CellFeatures& fine) {
  const int factor = fine.grid().rows / grid_.rows;
  assert(fine.lanes() == lanes_ && fine.grid().cols / grid_.cols == factor);
  for (int row = 0; row < grid_.rows; ++row) {
    for (int col = 0; col < grid_.cols; ++col) {
      average_block(fine.cell(row * factor, col * factor), fine.row_stride(), factor, lanes_,
                    mutable_cell(row, col));
    }
  }
}

}  // namespace bevloc
