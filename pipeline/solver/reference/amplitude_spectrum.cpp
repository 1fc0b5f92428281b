#include "pipeline/solver/reference/amplitude_spectrum.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "common/target_clones.h"

namespace bevloc {
namespace {

std::vector<float> samples_of(Window window, int size) {
  std::vector<float> samples(size, 1.0F);
  for (int n = 0; window == Window::kHann && n < size; ++n) {
    samples[n] = static_cast<float>(0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * n / (size - 1)));
  }
  return samples;
}

/// Writes a column of cells times the window, and zeros up to `length`.
BEVLOC_TARGET_CLONES void load_column(const float* cells, std::ptrdiff_t row_stride,
                                      const float* window, float weight, int rows, int length,
                                      float* out) {
  for (int row = 0; row < rows; ++row) {
    lanes(out + row * kLanes) = weight * window[row] * lanes(cells + row * row_stride);
  }
  for (int row = rows; row < length; ++row) lanes(out + row * kLanes) = Lanes{};
}

BEVLOC_TARGET_CLONES void load_row(const float* row, int cols, int length, FftTile& tile) {
  for (int col = 0; col < cols; ++col) {
    lanes(tile.re.data() + col * kLanes) = lanes(row + 2 * col * kLanes);
    lanes(tile.im.data() + col * kLanes) = lanes(row + (2 * col + 1) * kLanes);
  }
  for (int col = cols; col < length; ++col) {
    lanes(tile.re.data() + col * kLanes) = Lanes{};
    lanes(tile.im.data() + col * kLanes) = Lanes{};
  }
}

/// Writes the amplitudes of two real signals a and b with the transforms A and B. Z is the
/// transform of a + ib. `own` holds Z(k), and `mirror` holds Z(-k) in reverse order:
/// 2 A = Z(k) + conj Z(-k), 2 i B = Z(k) - conj Z(-k).
BEVLOC_TARGET_CLONES void separate(const FftTile& own, const FftTile& mirror, int cols, int count,
                                   std::ptrdiff_t step, float* a, float* b) {
  for (int col = 0; col < count; ++col) {
    const int reflected = (col == 0 ? 0 : cols - col) * kLanes;
    const Lanes& own_re = lanes(own.re.data() + col * kLanes);
    const Lanes& own_im = lanes(own.im.data() + col * kLanes);
    const Lanes& mirror_re = lanes(mirror.re.data() + reflected);
    const Lanes& mirror_im = lanes(mirror.im.data() + reflected);
    const Lanes a_re = own_re + mirror_re;
    const Lanes a_im = own_im - mirror_im;
    const Lanes b_re = own_im + mirror_im;
    const Lanes b_im = mirror_re - own_re;
    const Lanes a_square = a_re * a_re + a_im * a_im;
    const Lanes b_square = b_re * b_re + b_im * b_im;
    float* a_out = a + col * step;
    float* b_out = b + col * step;
    for (int k = 0; k < kLanes; ++k) a_out[k] = 0.5F * std::sqrt(a_square[k]);
    for (int k = 0; k < kLanes; ++k) b_out[k] = 0.5F * std::sqrt(b_square[k]);
  }
}

}  // namespace

AmplitudeSpectrum::AmplitudeSpectrum(const BevGrid& grid, int channels, int rows, int cols,
                                     Window window, double farthest)
    : grid_(grid),
      lanes_(round_up_to_lanes(channels)),
      stored_cols_(cols / 2 + 1),
      row_window_(samples_of(window, grid.rows)),
      col_window_(samples_of(window, grid.cols)),
      column_fft_(rows),
      row_fft_(cols),
      column_tile_(rows),
      own_row_(cols),
      mirror_row_(cols),
      half_transformed_(static_cast<size_t>(rows) * grid.cols * 2 * kLanes) {
  assert(grid.rows <= rows && grid.cols <= cols);
  for (int row = 0; row < rows; ++row) {
    const double frequency = std::min(row, rows - row);
    const double within = std::sqrt(std::max(farthest * farthest - frequency * frequency, 0.0));
    const bool none = frequency > farthest;
    cols_to_store_.push_back(none ? 0 : std::min(stored_cols_, static_cast<int>(within) + 1));
  }
  for (LaneBuffer& amplitude : amplitude_) {
    amplitude.resize(static_cast<size_t>(rows) * stored_cols_ * lanes_);
  }
}

void AmplitudeSpectrum::compute(const CellFeatures& first, const CellFeatures& second) {
  for (int first_lane = 0; first_lane < lanes_; first_lane += kLanes) {
    for (int col = 0; col < grid_.cols; ++col) transform_column(first, second, col, first_lane);
    // A row frequency and its mirror image: both are needed to separate the two sides.
    for (int row = 0; row <= rows() / 2 && cols_to_store_[row] > 0; ++row) {
      const int mirror = (rows() - row) % rows();
      transform_row(row, own_row_);
      transform_row(mirror, mirror_row_);
      store_amplitudes(row, own_row_, mirror_row_, first_lane);
      store_amplitudes(mirror, mirror_row_, own_row_, first_lane);
    }
  }
}

void AmplitudeSpectrum::transform_column(const CellFeatures& first, const CellFeatures& second,
                                         int col, int first_lane) {
  load_column(first.cell(0, col) + first_lane, first.row_stride(), row_window_.data(),
              col_window_[col], grid_.rows, rows(), column_tile_.re.data());
  load_column(second.cell(0, col) + first_lane, second.row_stride(), row_window_.data(),
              col_window_[col], grid_.rows, rows(), column_tile_.im.data());
  float* target = half_transformed_.data() + static_cast<std::ptrdiff_t>(2) * col * kLanes;
  column_fft_.transform_to(column_tile_, target, target + kLanes,
                           static_cast<std::ptrdiff_t>(2) * grid_.cols * kLanes);
}

void AmplitudeSpectrum::transform_row(int row_frequency, FftTile& tile) {
  const bool half = row_fft_.can_halve() && 2 * grid_.cols <= cols();
  const float* row = half_transformed_.data() +
                     static_cast<std::ptrdiff_t>(row_frequency) * 2 * grid_.cols * kLanes;
  load_row(row, grid_.cols, half ? cols() / 2 : cols(), tile);
  if (half) {
    row_fft_.transform_half(tile);
  } else {
    row_fft_.transform(tile);
  }
}

void AmplitudeSpectrum::store_amplitudes(int row_frequency, const FftTile& own,
                                         const FftTile& mirror, int first_lane) {
  const int begin = offset(row_frequency, 0) + first_lane;
  separate(own, mirror, cols(), cols_to_store_[row_frequency], lanes_, amplitude_[0].data() + begin,
           amplitude_[1].data() + begin);
}

}  // namespace bevloc
