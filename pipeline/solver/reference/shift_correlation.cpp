#include "pipeline/solver/reference/shift_correlation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "common/target_clones.h"

namespace bevloc {
namespace {

/// kLanes real channels form kPairs complex signals: channel k is the real part of signal k,
/// channel k + kPairs its imaginary part.
constexpr int kPairs = kLanes / 2;
/// Rows or columns that fill a tile.
constexpr int kPerTile = kLanes / kPairs;

/// product += conj(map) * features. `map` is [frequency, real and imaginary part, kLanes].
BEVLOC_TARGET_CLONES void add_product(const float* map, const FftTile& features, int length,
                                      FftTile& product) {
  for (int i = 0; i < length * kLanes; i += kLanes) {
    const Lanes& map_re = lanes(map + 2 * i);
    const Lanes& map_im = lanes(map + 2 * i + kLanes);
    const Lanes& re = lanes(features.re.data() + i);
    const Lanes& im = lanes(features.im.data() + i);
    lanes(product.re.data() + i) += map_re * re + map_im * im;
    lanes(product.im.data() + i) += map_re * im - map_im * re;
  }
}

/// Computes the inverse transform of every lane at the shifts +n and -n. The layout of `phase` is
/// [frequency, cos and sin]. `plus` and `minus` get a real and an imaginary part each.
BEVLOC_TARGET_CLONES void at_shifts(const FftTile& product, const float* phase, int length,
                                    Lanes* plus, Lanes* minus) {
  // p e^(+-i a) = (re cos -+ im sin) + i (im cos +- re sin), so four sums serve both shifts.
  Lanes re_cos = {};
  Lanes re_sin = {};
  Lanes im_cos = {};
  Lanes im_sin = {};
  for (int l = 0; l < length; ++l) {
    const Lanes& re = lanes(product.re.data() + l * kLanes);
    const Lanes& im = lanes(product.im.data() + l * kLanes);
    re_cos += phase[2 * l] * re;
    re_sin += phase[2 * l + 1] * re;
    im_cos += phase[2 * l] * im;
    im_sin += phase[2 * l + 1] * im;
  }
  plus[0] = re_cos - im_sin;
  plus[1] = im_cos + re_sin;
  minus[0] = re_cos + im_sin;
  minus[1] = im_cos - re_sin;
}

/// Sums of the first and of the last kPairs lanes, which belong to two row frequencies.
std::pair<double, double> halves(const Lanes& values) {
  double sums[2] = {};
  for (int k = 0; k < kLanes; ++k) sums[k / kPairs] += values[k];
  return {sums[0], sums[1]};
}

}  // namespace

ShiftCorrelation::ShiftCorrelation(const BevGrid& grid, int channels, const ShiftRange& shifts)
    : shifts_(shifts),
      rows_(grid.rows + 2 * shifts.rows),
      cols_(grid.cols + 2 * shifts.cols),
      lanes_(round_up_to_lanes(channels)),
      column_fft_(LanesFft::power_of_two_from(rows_)),
      row_fft_(LanesFft::power_of_two_from(cols_)),
      column_tile_(column_fft_.length()),
      row_tile_(row_fft_.length()),
      product_(row_fft_.length()),
      half_transformed_(static_cast<size_t>(column_fft_.length()) * cols_ * lanes_),
      map_(static_cast<size_t>(column_fft_.length()) * row_fft_.length() * lanes_) {
  for (int n = 0; n <= shifts.cols; ++n) {
    for (int l = 0; l < row_fft_.length(); ++l) {
      const double angle = 2.0 * std::numbers::pi * n * l / row_fft_.length();
      col_phase_.push_back(static_cast<float>(std::cos(angle)));
      col_phase_.push_back(static_cast<float>(std::sin(angle)));
    }
  }
  const double share = 1.0 / (static_cast<double>(column_fft_.length()) * row_fft_.length());
  for (int k = 0; k < column_fft_.length(); ++k) {
    for (int m = -shifts.rows; m <= shifts.rows; ++m) {
      const double angle = 2.0 * std::numbers::pi * m * k / column_fft_.length();
      row_phase_.push_back(share * std::cos(angle));
      row_phase_.push_back(share * std::sin(angle));
    }
  }
}

/// Transforms every column of the frame. Two columns fill a tile.
void ShiftCorrelation::transform_columns(const float* frame, std::ptrdiff_t row_stride) {
  float* out = half_transformed_.data();
  for (int group = 0; group < lanes_; group += kLanes) {
    for (int col = 0; col < cols_; col += kPerTile) {
      std::ranges::fill(column_tile_.re, 0.0F);
      std::ranges::fill(column_tile_.im, 0.0F);
      const int cols = std::min(kPerTile, cols_ - col);
      for (int row = 0; row < rows_; ++row) {
        const float* cell = frame + row * row_stride + col * lanes_ + group;
        for (int c = 0; c < cols; ++c, cell += lanes_) {
          const int slot = row * kLanes + c * kPairs;
          std::copy_n(cell, kPairs, column_tile_.re.data() + slot);
          std::copy_n(cell + kPairs, kPairs, column_tile_.im.data() + slot);
        }
      }
      column_fft_.transform(column_tile_);
      for (int k = 0; k < column_fft_.length(); ++k) {
        for (int c = 0; c < cols; ++c) {
          float* target = out + (static_cast<size_t>(k) * cols_ + col + c) * kLanes;
          std::copy_n(column_tile_.re.data() + k * kLanes + c * kPairs, kPairs, target);
          std::copy_n(column_tile_.im.data() + k * kLanes + c * kPairs, kPairs, target + kPairs);
        }
      }
    }
    out += static_cast<size_t>(column_fft_.length()) * cols_ * kLanes;
  }
}

/// Transforms the rows of two row frequencies, which fill a tile, for one lane group.
void ShiftCorrelation::transform_rows(int first_row, int group) {
  std::ranges::fill(row_tile_.re, 0.0F);
  std::ranges::fill(row_tile_.im, 0.0F);
  const size_t first = (static_cast<size_t>(group) * column_fft_.length() + first_row) * cols_;
  for (int k = 0; k < kPerTile; ++k) {
    const float* source =
        half_transformed_.data() + (first + static_cast<size_t>(k) * cols_) * kLanes;
    for (int col = 0; col < cols_; ++col, source += kLanes) {
      std::copy_n(source, kPairs, row_tile_.re.data() + col * kLanes + k * kPairs);
      std::copy_n(source + kPairs, kPairs, row_tile_.im.data() + col * kLanes + k * kPairs);
    }
  }
  row_fft_.transform(row_tile_);
}

void ShiftCorrelation::set_map(const CellFeatures& map) {
  // The margin of the map supplies the border of zeros.
  transform_columns(map.cell(-shifts_.rows, -shifts_.cols), map.row_stride());
  float* out = map_.data();
  for (int row = 0; row < column_fft_.length(); row += kPerTile) {
    for (int group = 0; group < lanes_ / kLanes; ++group) {
      transform_rows(row, group);
      for (int i = 0; i < row_fft_.length() * kLanes; i += kLanes, out += 2 * kLanes) {
        std::copy_n(row_tile_.re.data() + i, kLanes, out);
        std::copy_n(row_tile_.im.data() + i, kLanes, out + kLanes);
      }
    }
  }
}

void ShiftCorrelation::correlate(const LaneBuffer& frame, std::span<double> correlation) {
  transform_columns(frame.data(), static_cast<std::ptrdiff_t>(cols_) * lanes_);
  std::ranges::fill(correlation, 0.0);
  const float* map = map_.data();
  for (int row = 0; row < column_fft_.length(); row += kPerTile) {
    std::ranges::fill(product_.re, 0.0F);
    std::ranges::fill(product_.im, 0.0F);
    for (int group = 0; group < lanes_ / kLanes; ++group) {
      transform_rows(row, group);
      add_product(map, row_tile_, row_fft_.length(), product_);
      map += static_cast<size_t>(2) * row_fft_.length() * kLanes;
    }
    add_shifts(row, correlation);
  }
}

void ShiftCorrelation::add_shifts(int first_row, std::span<double> correlation) const {
  for (int n = 0; n <= shifts_.cols; ++n) {
    Lanes plus[2];
    Lanes minus[2];
    const float* phase = col_phase_.data() + static_cast<size_t>(2) * n * row_fft_.length();
    at_shifts(product_, phase, row_fft_.length(), plus, minus);
    add_shift(first_row, n, plus, correlation);
    if (n > 0) add_shift(first_row, -n, minus, correlation);
  }
}

/// Adds the contribution of two row frequencies to all row shifts of one column shift.
void ShiftCorrelation::add_shift(int first_row, int col_shift, const Lanes* value,
                                 std::span<double> correlation) const {
  double re[kPerTile];
  double im[kPerTile];
  std::tie(re[0], re[1]) = halves(value[0]);
  std::tie(im[0], im[1]) = halves(value[1]);
  for (int k = 0; k < kPerTile; ++k) {
    const double* phase =
        row_phase_.data() + static_cast<size_t>(2) * (first_row + k) * shifts_.row_count();
    for (int m = -shifts_.rows; m <= shifts_.rows; ++m, phase += 2) {
      correlation[shifts_.index(m, col_shift)] += phase[0] * re[k] - phase[1] * im[k];
    }
  }
}

}  // namespace bevloc
