// Scores every hypothesis (yaw, x, y) at once from correlations of blocks, with gradients. Training
// and the `block` solver share this code.
#pragma once

#include <span>
#include <vector>

#include "pipeline/bev_grid.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc {

namespace joint_volume {

/// Sizes of one block of B and of the padded map. Strides are in floats.
struct BlockShape {
  int channels;
  int rows;
  int cols;
  int bev_row_stride;
  int bev_channel_stride;
  int map_row_stride;
  int map_channel_stride;
  int row_shifts;
  int col_shifts;
};

/// Where the hypotheses of one yaw read the correlations of one block, and with which weights.
struct Lookup {
  const int* row;           ///< [x]: the first of four row shifts
  const float* row_weight;  ///< [x, 4]: their weights
  const float* y_of_col;    ///< [column shift, padded y]: interpolation weights
  const float* col_of_y;    ///< [y, column shift]: the same
  int x_count;
  int y_count;
  int padded_y;
  int col_begin;  ///< the y hypotheses read column shifts col_begin ... col_end - 1
  int col_end;
  int col_shifts;
};

}  // namespace joint_volume

/// Scores all hypotheses (paper, eq. 4 and 5, but with features that are standardised only once).
///
/// Definition. B and M are the standardised BEV and map features, [channels, rows, cols]: each
/// channel is (f - mean) / (std + 0.01) over all cells. They are zero outside the grid. B is
/// divided into blocks of `block_cells` x `block_cells` cells. If that does not divide the grid,
/// the last blocks are smaller. For block b and whole shifts (m, n) in cells
///
///   K_b[m, n] = sum over channels c and cells (u, v) of b of B[c, u, v] M[c, u + m, v + n].
///
/// Hypothesis T = (x, y, a) maps points of the vehicle frame to the map, p_M = R(a) p_B + t. It
/// moves the block with centre p_b (in metres, x forward, y left) as a whole by d = R(a) p_b + t -
/// p_b, which is m = -d.x / cell_m rows and n = -d.y / cell_m columns. Then
///
///   volume[a, x, y] = sum over b of K_b(m, n) / (channels * rows * cols).
///
/// K_b is read between whole shifts by cubic convolution along each axis (Keys 1981, a = -1/2). Its
/// four weights at fraction t are (-t + 2 t^2 - t^3) / 2, (2 - 5 t^2 + 3 t^3) / 2,
/// (t + 4 t^2 - 3 t^3) / 2 and (-t^2 + t^3) / 2. It reproduces parabolas; linear interpolation
/// would put every peak on a whole cell. The layout of the volume is [yaw, x, y], hypotheses
/// increasing.
///
/// The constructor allocates all memory; the other functions allocate nothing. One thread.
class JointVolume {
 public:
  JointVolume(const HypothesisGrid& hypotheses, const BevGrid& grid, int channels,
              int block_cells = 5);

  int hypothesis_count() const { return yaw_count_ * x_count_ * y_count_; }
  int feature_count() const { return channels_ * grid_.cells(); }

  /// Writes hypothesis_count() scores. `bev` and `map` have feature_count() values each.
  void scores(std::span<const float> bev, std::span<const float> map, std::span<float> volume);

  /// Writes the gradients of sum(grad_volume * volume) with respect to `bev` and `map`.
  void gradients(std::span<const float> bev, std::span<const float> map,
                 std::span<const float> grad_volume, std::span<float> grad_bev,
                 std::span<float> grad_map);

 private:
  struct Block {
    int row = 0;  ///< first row
    int col = 0;  ///< first column
    int rows = 0;
    int cols = 0;
  };

  void make_blocks(int block_cells);
  void make_shift_ranges();
  void make_scratch();
  double row_displacement(const Block& block, double yaw_rad) const;
  double col_displacement(const Block& block, double yaw_rad) const;
  void pad_map(std::span<const float> map);
  void correlation_gradients(std::span<const float> grad_volume);
  joint_volume::BlockShape shape(const Block& block) const;
  joint_volume::Lookup look_up(const Block& block, double yaw_rad);
  float* correlation(size_t block) { return correlation_.data() + block * correlation_size_; }
  float* scores_of_yaw(int a) {
    return volume_.data() + static_cast<size_t>(a) * x_count_ * padded_y_;
  }
  size_t feature_offset(const Block& block) const {
    return static_cast<size_t>(block.row) * grid_.cols + block.col;
  }
  size_t padded_row(int channel, int row) const {
    return (static_cast<size_t>(channel) * padded_rows_ + row + row_shift_) * padded_cols_ +
           col_shift_;
  }
  size_t padded_offset(const Block& block) const {
    return static_cast<size_t>(block.row) * padded_cols_ + block.col;
  }
  float normalisation() const { return 1.0F / static_cast<float>(feature_count()); }

  HypothesisGrid hypotheses_;
  BevGrid grid_;
  int channels_;
  int yaw_count_;
  int x_count_;
  int y_count_;
  std::vector<Block> blocks_;

  int row_shift_ = 0;   ///< row shifts are -row_shift_ ... row_shift_
  int col_shift_ = 0;   ///< column shifts are -col_shift_ ... col_shift_
  int row_shifts_ = 0;  ///< number of row shifts, padded to whole groups
  int col_shifts_ = 0;  ///< number of column shifts, padded to whole vectors
  int padded_y_ = 0;    ///< number of y hypotheses, padded to whole vectors
  int padded_rows_ = 0;
  int padded_cols_ = 0;
  size_t correlation_size_ = 0;

  std::vector<float> padded_map_;   ///< [channels, padded rows, padded columns]
  std::vector<float> correlation_;  ///< [block, row shift, column shift], or its gradient
  std::vector<float> volume_;       ///< [yaw, x, padded y], or its gradient
  std::vector<float> line_;         ///< correlations of one x hypothesis, by column shift
  // Storage of joint_volume::Lookup.
  std::vector<int> row_;
  std::vector<float> row_weight_;
  std::vector<float> y_of_col_;
  std::vector<float> col_of_y_;
};

}  // namespace bevloc
