#include "pipeline/solver/reference/axis_matching.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/target_clones.h"
#include "pipeline/solver/feature_warp.h"
#include "pipeline/solver/lane_sums.h"
#include "pipeline/solver/shift_range.h"

namespace bevloc {
namespace {

constexpr float kVarianceEpsilon = 1e-3F;

/// Width of the border in cells: the largest shift.
int crop_of(const BevGrid& grid, const HypothesisGrid& hypotheses) {
  return whole_cells(std::max(hypotheses.x_m.farthest(), hypotheses.y_m.farthest()), grid.cell_m);
}

/// Subtracts from each of kLanes channels its mean over the cells.
BEVLOC_TARGET_CLONES void center(float* values, int cells, int lane_count) {
  Lanes mean = {};
  for (int i = 0; i < cells; ++i) mean += lanes(values + i * lane_count);
  mean /= static_cast<float>(cells);
  for (int i = 0; i < cells; ++i) lanes(values + i * lane_count) -= mean;
}

/// Sum over kLanes channels of the normalised correlation of the map's axis features with those of
/// the BEV, which are read `fraction` of a cell further on. The map's must have mean zero.
BEVLOC_TARGET_CLONES float correlate(const float* bev, float fraction, const float* map, int cells,
                                     int lane_count) {
  Lanes product = {};
  Lanes bev_sum = {};
  Lanes bev_square = {};
  Lanes map_square = {};
  for (int i = 0; i < cells * lane_count; i += lane_count) {
    const Lanes shifted =
        (1.0F - fraction) * lanes(bev + i) + fraction * lanes(bev + lane_count + i);
    product += shifted * lanes(map + i);
    bev_sum += shifted;
    bev_square += shifted * shifted;
    map_square += lanes(map + i) * lanes(map + i);
  }
  const float share = 1.0F / static_cast<float>(cells);
  float sum = 0.0F;
  for (int c = 0; c < kLanes; ++c) {
    const float mean = share * bev_sum[c];
    const float bev_variance = std::max(share * bev_square[c] - mean * mean, 0.0F);
    sum +=
        share * product[c] /
        std::sqrt((bev_variance + kVarianceEpsilon) * (share * map_square[c] + kVarianceEpsilon));
  }
  return sum;
}

}  // namespace

AxisMatching::AxisMatching(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses)
    : grid_(grid),
      channels_(channels),
      lanes_(round_up_to_lanes(channels)),
      crop_(crop_of(grid, hypotheses)),
      hypotheses_(hypotheses) {
  assert(2 * crop_ < std::min(grid.rows, grid.cols));
  // One cell more than the grid, because interpolation at a whole shift reads it with weight zero.
  for (AxisFeatures* features : {&bev_, &map_}) {
    features->x.resize(static_cast<size_t>(grid.rows + 1) * lanes_);
    features->y.resize(static_cast<size_t>(grid.cols + 1) * lanes_);
  }
  warped_row_.resize(static_cast<size_t>(grid.cols) * lanes_);
}

void AxisMatching::set_features(const CellFeatures& bev, double yaw_rad, const CellFeatures& map) {
  std::ranges::fill(bev_.y, 0.0F);
  std::ranges::fill(map_.y, 0.0F);
  const FeatureWarp rotated(bev, yaw_rad);
  for (int row = 0; row < grid_.rows; ++row) {
    warp(rotated.line(row, 0, grid_.cols), warped_row_.data());
    average_row(warped_row_.data(), row, bev_);
    average_row(map.cell(row, 0), row, map_);
  }
  // The matched cells of the map are the same for every hypothesis, so they are centred once.
  for (int k = 0; k < lanes_; k += kLanes) {
    center(map_.x.data() + crop_ * lanes_ + k, grid_.rows - 2 * crop_, lanes_);
    center(map_.y.data() + crop_ * lanes_ + k, grid_.cols - 2 * crop_, lanes_);
  }
}

void AxisMatching::average_row(const float* cells, int row, AxisFeatures& out) const {
  const int inner = grid_.cols - 2 * crop_;
  float* x = out.x.data() + row * lanes_;
  std::fill_n(x, lanes_, 0.0F);
  add_weighted_sum(cells + crop_ * lanes_, inner, 1.0F / static_cast<float>(inner), lanes_, x);
  if (row < crop_ || row >= grid_.rows - crop_) return;
  const float weight = 1.0F / static_cast<float>(grid_.rows - 2 * crop_);
  add_weighted(cells, weight, grid_.cols * lanes_, out.y.data());
}

void AxisMatching::score_x(std::span<double> scores) const {
  score(bev_.x, map_.x, grid_.rows, hypotheses_.x_m, scores);
}

void AxisMatching::score_y(std::span<double> scores) const {
  score(bev_.y, map_.y, grid_.cols, hypotheses_.y_m, scores);
}

void AxisMatching::score(const LaneBuffer& bev, const LaneBuffer& map, int cells,
                         const HypothesisAxis& axis, std::span<double> scores) const {
  for (int i = 0; i < axis.count(); ++i) {
    const SplitShift shift = split_shift(axis.value(i) / grid_.cell_m);
    double sum = 0.0;
    for (int k = 0; k < lanes_; k += kLanes) {
      sum += correlate(bev.data() + (crop_ + shift.whole) * lanes_ + k,
                       static_cast<float>(shift.fraction), map.data() + crop_ * lanes_ + k,
                       cells - 2 * crop_, lanes_);
    }
    scores[i] = sum / channels_;
  }
}

}  // namespace bevloc
