#include "pipeline/solver/reference/joint_volume.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "common/target_clones.h"
#include "pipeline/solver/cubic.h"
#include "pipeline/solver/lanes.h"

namespace bevloc {
namespace {

/// Row shifts that are summed together, to hide the latency of the additions.
constexpr int kMapGroup = 7;

/// Writes correlation[m, n] = sum of bev[c, u, v] * map[c, u + m, v + n].
BEVLOC_TARGET_CLONES void correlate_block(const joint_volume::BlockShape& s, const float* bev,
                                          const float* map, float* correlation) {
  for (int m = 0; m < s.row_shifts; m += kMapGroup) {
    for (int n = 0; n < s.col_shifts; n += kLanes) {
      Lanes sum[kMapGroup] = {};
      for (int c = 0; c < s.channels; ++c) {
        for (int u = 0; u < s.rows; ++u) {
          const float* bev_row = bev + c * s.bev_channel_stride + u * s.bev_row_stride;
          const float* map_row = map + c * s.map_channel_stride + (u + m) * s.map_row_stride + n;
          for (int v = 0; v < s.cols; ++v) {
            for (int g = 0; g < kMapGroup; ++g) {
              sum[g] += bev_row[v] * lanes(map_row + g * s.map_row_stride + v);
            }
          }
        }
      }
      for (int g = 0; g < kMapGroup; ++g) lanes(correlation + (m + g) * s.col_shifts + n) = sum[g];
    }
  }
}

/// Writes the gradient of correlate_block() with respect to its block of B.
BEVLOC_TARGET_CLONES void correlate_block_grad_bev(const joint_volume::BlockShape& s,
                                                   const float* grad, const float* map,
                                                   float* grad_bev) {
  for (int c = 0; c < s.channels; ++c) {
    for (int u = 0; u < s.rows; ++u) {
      for (int v = 0; v < s.cols; ++v) {
        const float* corner = map + c * s.map_channel_stride + u * s.map_row_stride + v;
        Lanes sum = {};
        for (int m = 0; m < s.row_shifts; ++m) {
          for (int n = 0; n < s.col_shifts; n += kLanes) {
            sum += lanes(grad + m * s.col_shifts + n) * lanes(corner + m * s.map_row_stride + n);
          }
        }
        grad_bev[c * s.bev_channel_stride + u * s.bev_row_stride + v] = sum_of(sum);
      }
    }
  }
}

/// Adds the gradient of correlate_block() with respect to the padded map.
BEVLOC_TARGET_CLONES void correlate_block_grad_map(const joint_volume::BlockShape& s,
                                                   const float* grad, const float* bev,
                                                   float* grad_map) {
  for (int c = 0; c < s.channels; ++c) {
    const float* bev_block = bev + c * s.bev_channel_stride;
    for (int row = 0; row < s.rows + s.row_shifts - 1; ++row) {
      float* map_row = grad_map + c * s.map_channel_stride + row * s.map_row_stride;
      const int first = std::max(0, row - s.row_shifts + 1);
      const int last = std::min(s.rows - 1, row);
      for (int v = 0; v < s.cols; ++v) {
        for (int n = 0; n < s.col_shifts; n += kLanes) {
          Lanes sum = lanes(map_row + v + n);
          for (int u = first; u <= last; ++u) {
            sum += bev_block[u * s.bev_row_stride + v] * lanes(grad + (row - u) * s.col_shifts + n);
          }
          lanes(map_row + v + n) = sum;
        }
      }
    }
  }
}

/// Adds the correlations of one block to the scores [x, padded y] of one yaw.
BEVLOC_TARGET_CLONES void add_scores(const joint_volume::Lookup& l, const float* correlation,
                                     float* line, float* scores) {
  for (int i = 0; i < l.x_count; ++i) {
    const float* first = correlation + l.row[i] * l.col_shifts;
    const float* weight = l.row_weight + i * kCubicTaps;
    for (int n = 0; n < l.col_shifts; n += kLanes) {
      Lanes sum = {};
      for (int k = 0; k < kCubicTaps; ++k) sum += weight[k] * lanes(first + k * l.col_shifts + n);
      lanes(line + n) = sum;
    }
    for (int j = 0; j < l.padded_y; j += kLanes) {
      Lanes sum = lanes(scores + i * l.padded_y + j);
      for (int n = l.col_begin; n < l.col_end; ++n) {
        sum += line[n] * lanes(l.y_of_col + n * l.padded_y + j);
      }
      lanes(scores + i * l.padded_y + j) = sum;
    }
  }
}

/// Adds the gradient of add_scores() with respect to the correlations of the block.
BEVLOC_TARGET_CLONES void add_scores_grad(const joint_volume::Lookup& l, const float* grad_scores,
                                          float* grad_correlation) {
  for (int i = 0; i < l.x_count; ++i) {
    float* first = grad_correlation + l.row[i] * l.col_shifts;
    const float* weight = l.row_weight + i * kCubicTaps;
    for (int n = 0; n < l.col_shifts; n += kLanes) {
      Lanes sum = {};
      for (int j = 0; j < l.y_count; ++j) {
        sum += grad_scores[i * l.padded_y + j] * lanes(l.col_of_y + j * l.col_shifts + n);
      }
      for (int k = 0; k < kCubicTaps; ++k) lanes(first + k * l.col_shifts + n) += weight[k] * sum;
    }
  }
}

}  // namespace

JointVolume::JointVolume(const HypothesisGrid& hypotheses, const BevGrid& grid, int channels,
                         int block_cells)
    : hypotheses_(hypotheses),
      grid_(grid),
      channels_(channels),
      yaw_count_(hypotheses.yaw_rad.count()),
      x_count_(hypotheses.x_m.count()),
      y_count_(hypotheses.y_m.count()) {
  assert(channels > 0 && block_cells > 0 && grid.cells() > 0);
  make_blocks(block_cells);
  make_shift_ranges();
  make_scratch();
}

void JointVolume::make_blocks(int block_cells) {
  for (int row = 0; row < grid_.rows; row += block_cells) {
    for (int col = 0; col < grid_.cols; col += block_cells) {
      blocks_.push_back({row, col, std::min(block_cells, grid_.rows - row),
                         std::min(block_cells, grid_.cols - col)});
    }
  }
}

/// Rows by which the rotation moves the centre of the block.
double JointVolume::row_displacement(const Block& block, double yaw_rad) const {
  const double x_m = grid_.x_of_row(block.row + 0.5 * (block.rows - 1));
  const double y_m = grid_.y_of_col(block.col + 0.5 * (block.cols - 1));
  return -(std::cos(yaw_rad) * x_m - std::sin(yaw_rad) * y_m - x_m) / grid_.cell_m;
}

/// Columns by which the rotation moves the centre of the block.
double JointVolume::col_displacement(const Block& block, double yaw_rad) const {
  const double x_m = grid_.x_of_row(block.row + 0.5 * (block.rows - 1));
  const double y_m = grid_.y_of_col(block.col + 0.5 * (block.cols - 1));
  return -(std::sin(yaw_rad) * x_m + std::cos(yaw_rad) * y_m - y_m) / grid_.cell_m;
}

void JointVolume::make_shift_ranges() {
  double row = 0.0;
  double col = 0.0;
  for (const Block& block : blocks_) {
    for (int a = 0; a < yaw_count_; ++a) {
      const double yaw_rad = hypotheses_.yaw_rad.value(a);
      row = std::max(row, std::abs(row_displacement(block, yaw_rad)));
      col = std::max(col, std::abs(col_displacement(block, yaw_rad)));
    }
  }
  // Interpolation reads up to two whole shifts beyond the largest displacement.
  row_shift_ = static_cast<int>(row + hypotheses_.x_m.value(x_count_ - 1) / grid_.cell_m) + 2;
  col_shift_ = static_cast<int>(col + hypotheses_.y_m.value(y_count_ - 1) / grid_.cell_m) + 2;
}

void JointVolume::make_scratch() {
  row_shifts_ = ((2 * row_shift_ + 1) + kMapGroup - 1) / kMapGroup * kMapGroup;
  col_shifts_ = round_up_to_lanes(2 * col_shift_ + 1);
  padded_y_ = round_up_to_lanes(y_count_);
  padded_rows_ = grid_.rows + row_shifts_;
  padded_cols_ = grid_.cols + col_shifts_;
  correlation_size_ = static_cast<size_t>(row_shifts_) * col_shifts_;
  padded_map_.resize(static_cast<size_t>(channels_) * padded_rows_ * padded_cols_);
  correlation_.resize(blocks_.size() * correlation_size_);
  volume_.resize(static_cast<size_t>(yaw_count_) * x_count_ * padded_y_);
  line_.resize(col_shifts_);
  row_.resize(x_count_);
  row_weight_.resize(static_cast<size_t>(x_count_) * kCubicTaps);
  y_of_col_.resize(static_cast<size_t>(col_shifts_) * padded_y_);
  col_of_y_.resize(static_cast<size_t>(y_count_) * col_shifts_);
}

void JointVolume::pad_map(std::span<const float> map) {
  std::ranges::fill(padded_map_, 0.0F);
  for (int c = 0; c < channels_; ++c) {
    for (int row = 0; row < grid_.rows; ++row) {
      std::copy_n(map.data() + (static_cast<size_t>(c) * grid_.rows + row) * grid_.cols, grid_.cols,
                  padded_map_.data() + padded_row(c, row));
    }
  }
}

joint_volume::BlockShape JointVolume::shape(const Block& block) const {
  return {channels_,
          block.rows,
          block.cols,
          grid_.cols,
          grid_.cells(),
          padded_cols_,
          padded_rows_ * padded_cols_,
          row_shifts_,
          col_shifts_};
}

joint_volume::Lookup JointVolume::look_up(const Block& block, double yaw_rad) {
  const double row0 = row_displacement(block, yaw_rad) + row_shift_;
  for (int i = 0; i < x_count_; ++i) {
    const CubicTaps taps = cubic_taps(row0 - hypotheses_.x_m.value(i) / grid_.cell_m);
    row_[i] = taps.first;
    std::ranges::copy(taps.weight, row_weight_.begin() + i * kCubicTaps);
  }
  std::ranges::fill(y_of_col_, 0.0F);
  std::ranges::fill(col_of_y_, 0.0F);
  int col_begin = col_shifts_;
  int col_end = 0;
  const double col0 = col_displacement(block, yaw_rad) + col_shift_;
  for (int j = 0; j < y_count_; ++j) {
    const CubicTaps taps = cubic_taps(col0 - hypotheses_.y_m.value(j) / grid_.cell_m);
    for (int k = 0; k < kCubicTaps; ++k) {
      const int col = taps.first + k;
      y_of_col_[col * padded_y_ + j] = taps.weight[k];
      col_of_y_[j * col_shifts_ + col] = taps.weight[k];
    }
    col_begin = std::min(col_begin, taps.first);
    col_end = std::max(col_end, taps.first + kCubicTaps);
  }
  return {row_.data(), row_weight_.data(), y_of_col_.data(), col_of_y_.data(), x_count_,
          y_count_,    padded_y_,          col_begin,        col_end,          col_shifts_};
}

void JointVolume::scores(std::span<const float> bev, std::span<const float> map,
                         std::span<float> volume) {
  assert(bev.size() == static_cast<size_t>(feature_count()) && map.size() == bev.size());
  assert(volume.size() == static_cast<size_t>(hypothesis_count()));
  pad_map(map);
  for (size_t b = 0; b < blocks_.size(); ++b) {
    correlate_block(shape(blocks_[b]), bev.data() + feature_offset(blocks_[b]),
                    padded_map_.data() + padded_offset(blocks_[b]), correlation(b));
  }
  std::ranges::fill(volume_, 0.0F);
  for (int a = 0; a < yaw_count_; ++a) {
    for (size_t b = 0; b < blocks_.size(); ++b) {
      add_scores(look_up(blocks_[b], hypotheses_.yaw_rad.value(a)), correlation(b), line_.data(),
                 scores_of_yaw(a));
    }
  }
  const float scale = normalisation();
  for (int i = 0; i < yaw_count_ * x_count_; ++i) {
    const float* source = volume_.data() + static_cast<size_t>(i) * padded_y_;
    for (int j = 0; j < y_count_; ++j) volume[i * y_count_ + j] = scale * source[j];
  }
}

void JointVolume::gradients(std::span<const float> bev, std::span<const float> map,
                            std::span<const float> grad_volume, std::span<float> grad_bev,
                            std::span<float> grad_map) {
  assert(bev.size() == static_cast<size_t>(feature_count()) && map.size() == bev.size());
  assert(grad_bev.size() == bev.size() && grad_map.size() == bev.size());
  assert(grad_volume.size() == static_cast<size_t>(hypothesis_count()));
  correlation_gradients(grad_volume);
  pad_map(map);
  for (size_t b = 0; b < blocks_.size(); ++b) {
    correlate_block_grad_bev(shape(blocks_[b]), correlation(b),
                             padded_map_.data() + padded_offset(blocks_[b]),
                             grad_bev.data() + feature_offset(blocks_[b]));
  }
  std::ranges::fill(padded_map_, 0.0F);
  for (size_t b = 0; b < blocks_.size(); ++b) {
    correlate_block_grad_map(shape(blocks_[b]), correlation(b),
                             bev.data() + feature_offset(blocks_[b]),
                             padded_map_.data() + padded_offset(blocks_[b]));
  }
  for (int c = 0; c < channels_; ++c) {
    for (int row = 0; row < grid_.rows; ++row) {
      std::copy_n(padded_map_.data() + padded_row(c, row), grid_.cols,
                  grad_map.data() + (static_cast<size_t>(c) * grid_.rows + row) * grid_.cols);
    }
  }
}

void JointVolume::correlation_gradients(std::span<const float> grad_volume) {
  std::ranges::fill(volume_, 0.0F);
  const float scale = normalisation();
  for (int i = 0; i < yaw_count_ * x_count_; ++i) {
    float* target = volume_.data() + static_cast<size_t>(i) * padded_y_;
    for (int j = 0; j < y_count_; ++j) target[j] = scale * grad_volume[i * y_count_ + j];
  }
  std::ranges::fill(correlation_, 0.0F);
  for (int a = 0; a < yaw_count_; ++a) {
    for (size_t b = 0; b < blocks_.size(); ++b) {
      add_scores_grad(look_up(blocks_[b], hypotheses_.yaw_rad.value(a)), scores_of_yaw(a),
                      correlation(b));
    }
  }
}

}  // namespace bevloc
