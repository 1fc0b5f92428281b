#include "pipeline/solver/amplitude_spectrum.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "common/target_clones.h"

namespace bevloc {
namespace {

/// A vector of sixteen real channels is eight complex signals: channel k and channel k + 8.
constexpr int kPairs = kLanes / 2;

std::vector<float> hann_window(int size) {
  std::vector<float> window(size);
  for (int n = 0; n < size; ++n) {
    window[n] = static_cast<float>(0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * n / (size - 1)));
  }
  return window;
}

/// Amplitudes of two real signals a and b from the transform of a + ib at frequencies k (`own`) and
/// -k (`mirror`): 2 A = Z(k) + conj Z(-k), 2 i B = Z(k) - conj Z(-k).
BEVLOC_TARGET_CLONES void separate(const float* own_re, const float* own_im, const float* mirror_re,
                                   const float* mirror_im, float* out) {
  for (int k = 0; k < kPairs; ++k) {
    const float a_re = own_re[k] + mirror_re[k];
    const float a_im = own_im[k] - mirror_im[k];
    const float b_re = own_im[k] + mirror_im[k];
    const float b_im = mirror_re[k] - own_re[k];
    out[k] = 0.5F * std::sqrt(a_re * a_re + a_im * a_im);
    out[kPairs + k] = 0.5F * std::sqrt(b_re * b_re + b_im * b_im);
  }
}

}  // namespace

AmplitudeSpectrum::AmplitudeSpectrum(const BevGrid& grid, int channels)
    : grid_(grid),
      lanes_(round_up_to_lanes(channels)),
      row_window_(hann_window(grid.rows)),
      col_window_(hann_window(grid.cols)),
      half_done_(static_cast<size_t>(kFftSize) * grid.cols * kLanes),
      amplitude_(static_cast<size_t>(kRows) * kCols * lanes_) {
  assert(grid.rows <= kFftSize && grid.cols <= kFftSize);
}

void AmplitudeSpectrum::compute(const CellFeatures& features) {
  for (int first_lane = 0; first_lane < lanes_; first_lane += kLanes) {
    transform_columns(features, first_lane);
    for (int row = 0; row <= kFftSize / 2; ++row) transform_rows(row, first_lane);
  }
}

/// Two columns fill a tile.
void AmplitudeSpectrum::transform_columns(const CellFeatures& features, int first_lane) {
  for (int col = 0; col < grid_.cols; col += 2) {
    tile_.re.fill(0.0F);
    tile_.im.fill(0.0F);
    const int cols = std::min(2, grid_.cols - col);
    for (int row = 0; row < grid_.rows; ++row) {
      for (int c = 0; c < cols; ++c) {
        const float* cell = features.cell(row, col + c) + first_lane;
        const float window = row_window_[row] * col_window_[col + c];
        const int slot = fft_slot(row) * kLanes + c * kPairs;
        for (int k = 0; k < kPairs; ++k) tile_.re[slot + k] = window * cell[k];
        for (int k = 0; k < kPairs; ++k) tile_.im[slot + k] = window * cell[kPairs + k];
      }
    }
    fft128(tile_);
    for (int row = 0; row < kFftSize; ++row) {
      for (int c = 0; c < cols; ++c) {
        float* target = half_done_.data() + (row * grid_.cols + col + c) * kLanes;
        std::copy_n(tile_.re.data() + row * kLanes + c * kPairs, kPairs, target);
        std::copy_n(tile_.im.data() + row * kLanes + c * kPairs, kPairs, target + kPairs);
      }
    }
  }
}

/// A row frequency and its mirror image fill a tile: what separates the pairs of channels is there.
void AmplitudeSpectrum::transform_rows(int row_frequency, int first_lane) {
  const int mirror = (kFftSize - row_frequency) % kFftSize;
  tile_.re.fill(0.0F);
  tile_.im.fill(0.0F);
  for (int col = 0; col < grid_.cols; ++col) {
    const int slot = fft_slot(col) * kLanes;
    const float* own = half_done_.data() + (row_frequency * grid_.cols + col) * kLanes;
    const float* other = half_done_.data() + (mirror * grid_.cols + col) * kLanes;
    std::copy_n(own, kPairs, tile_.re.data() + slot);
    std::copy_n(own + kPairs, kPairs, tile_.im.data() + slot);
    std::copy_n(other, kPairs, tile_.re.data() + slot + kPairs);
    std::copy_n(other + kPairs, kPairs, tile_.im.data() + slot + kPairs);
  }
  fft128(tile_);
  store_amplitude(row_frequency, 0, kPairs, first_lane);
  store_amplitude(mirror, kPairs, 0, first_lane);
}

void AmplitudeSpectrum::store_amplitude(int row_frequency, int own_lanes, int mirror_lanes,
                                        int first_lane) {
  for (int col = 0; col < kCols; ++col) {
    const int own = col * kLanes + own_lanes;
    const int mirror = (kFftSize - col) % kFftSize * kLanes + mirror_lanes;
    separate(tile_.re.data() + own, tile_.im.data() + own, tile_.re.data() + mirror,
             tile_.im.data() + mirror,
             amplitude_.data() + (row_frequency * kCols + col) * lanes_ + first_lane);
  }
}

}  // namespace bevloc
