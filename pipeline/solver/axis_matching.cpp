#include "pipeline/solver/axis_matching.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace bevloc {
namespace {

constexpr float kVarianceEpsilon = 1e-3F;
/// Shifts that differ from whole cells by less are whole.
constexpr double kWholeTolerance = 1e-9;

int crop_of(const BevGrid& grid, const HypothesisGrid& hypotheses) {
  const double shift = std::max(hypotheses.x_m.range, hypotheses.y_m.range) / grid.cell_m;
  return static_cast<int>(std::ceil(shift - kWholeTolerance));
}

/// Subtracts from sixteen channels their mean over the cells.
void center(float* values, int cells, int stride) {
  Lanes mean = {};
  for (int i = 0; i < cells; ++i) mean += lanes(values + i * stride);
  mean /= static_cast<float>(cells);
  for (int i = 0; i < cells; ++i) lanes(values + i * stride) -= mean;
}

/// Sum over sixteen channels of the correlation of two sides that have mean zero.
double correlation(const float* bev, const float* map, int cells, int stride) {
  Lanes product = {};
  Lanes bev_square = {};
  Lanes map_square = {};
  for (int i = 0; i < cells * stride; i += stride) {
    product += lanes(bev + i) * lanes(map + i);
    bev_square += lanes(bev + i) * lanes(bev + i);
    map_square += lanes(map + i) * lanes(map + i);
  }
  const auto count = static_cast<float>(cells);
  double sum = 0.0;
  for (int c = 0; c < kLanes; ++c) {
    sum += product[c] / count /
           std::sqrt((bev_square[c] / count + kVarianceEpsilon) *
                     (map_square[c] / count + kVarianceEpsilon));
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
  // One cell more than the grid: interpolation at a whole shift reads it with weight zero.
  for (AxisFeatures* features : {&bev_, &map_}) {
    features->x.resize(static_cast<size_t>(grid.rows + 1) * lanes_);
    features->y.resize(static_cast<size_t>(grid.cols + 1) * lanes_);
  }
  warped_row_.resize(static_cast<size_t>(grid.cols) * lanes_);
  shifted_.resize(static_cast<size_t>(std::max(grid.rows, grid.cols)) * lanes_);
}

void AxisMatching::set_features(const CellFeatures& bev, double yaw_rad, const CellFeatures& map) {
  average(bev, yaw_rad, bev_);
  average(map, 0.0, map_);
  // The map's side is the same for every hypothesis: centred once, over the cells that are matched.
  for (int k = 0; k < lanes_; k += kLanes) {
    center(map_.x.data() + crop_ * lanes_ + k, grid_.rows - 2 * crop_, lanes_);
    center(map_.y.data() + crop_ * lanes_ + k, grid_.cols - 2 * crop_, lanes_);
  }
}

void AxisMatching::average(const CellFeatures& features, double yaw_rad, AxisFeatures& out) {
  std::ranges::fill(out.x, 0.0F);
  std::ranges::fill(out.y, 0.0F);
  const float x_weight = 1.0F / static_cast<float>(grid_.cols - 2 * crop_);
  const float y_weight = 1.0F / static_cast<float>(grid_.rows - 2 * crop_);
  for (int row = 0; row < grid_.rows; ++row) {
    warp(features, {.yaw_rad = yaw_rad, .row = row, .cells = grid_.cols}, warped_row_.data());
    float* x = out.x.data() + row * lanes_;
    const bool row_counts = row >= crop_ && row < grid_.rows - crop_;
    for (int col = 0; col < grid_.cols; ++col) {
      const float* cell = warped_row_.data() + col * lanes_;
      const bool col_counts = col >= crop_ && col < grid_.cols - crop_;
      for (int k = 0; k < lanes_; k += kLanes) {
        if (col_counts) lanes(x + k) += x_weight * lanes(cell + k);
        if (row_counts) lanes(out.y.data() + col * lanes_ + k) += y_weight * lanes(cell + k);
      }
    }
  }
}

void AxisMatching::score_x(std::span<double> scores) {
  score(bev_.x, map_.x, grid_.rows, hypotheses_.x_m, scores);
}

void AxisMatching::score_y(std::span<double> scores) {
  score(bev_.y, map_.y, grid_.cols, hypotheses_.y_m, scores);
}

void AxisMatching::score(const std::vector<float>& bev, const std::vector<float>& map, int cells,
                         const HypothesisAxis& axis, std::span<double> scores) {
  const int matched = cells - 2 * crop_;
  for (int i = 0; i < axis.count(); ++i) {
    const double shift = axis.value(i) / grid_.cell_m;
    const int whole = static_cast<int>(std::floor(shift + kWholeTolerance));
    const auto fraction = static_cast<float>(std::max(shift - whole, 0.0));
    const float* source = bev.data() + (crop_ + whole) * lanes_;
    for (int k = 0; k < matched * lanes_; k += kLanes) {
      lanes(shifted_.data() + k) =
          (1.0F - fraction) * lanes(source + k) + fraction * lanes(source + lanes_ + k);
    }
    double sum = 0.0;
    for (int k = 0; k < lanes_; k += kLanes) {
      center(shifted_.data() + k, matched, lanes_);
      sum += correlation(shifted_.data() + k, map.data() + crop_ * lanes_ + k, matched, lanes_);
    }
    scores[i] = sum / channels_;
  }
}

}  // namespace bevloc
