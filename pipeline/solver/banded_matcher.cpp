#include "pipeline/solver/banded_matcher.h"

#include <algorithm>
#include <cmath>

#include "pipeline/solver/lane_sums.h"
#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

constexpr int kLateralBands = 10;
constexpr int kLongitudinalBands = 5;
constexpr float kBandStdEpsilon = 0.01F;

/// Replaces the scores by softmax(scale * score). Returns log(sum of exp(scale * score)).
double normalise(std::span<double> scores, double scale) {
  const double best = *std::ranges::max_element(scores);
  double sum = 0.0;
  for (double& score : scores) sum += score = std::exp(scale * (score - best));
  for (double& score : scores) score /= sum;
  return scale * best + std::log(sum);
}

}  // namespace

BandedMatcher::BandedMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                             const SolverParameters& parameters)
    : grid_(grid),
      channels_(channels),
      lanes_(round_up_to_lanes(channels)),
      hypotheses_(hypotheses),
      parameters_(parameters),
      yaw_scores_(hypotheses.yaw_rad.count()) {
  const int row_bands = std::min(kLateralBands, grid.rows);
  const int col_bands = std::min(kLongitudinalBands, grid.cols);
  for (int b = 0; b < row_bands; ++b) {
    const double center = 0.5 * (b * grid.rows / row_bands + (b + 1) * grid.rows / row_bands - 1);
    lateral_.lever_m.push_back(0.5 * (grid.rows - 1) * grid.cell_m - center * grid.cell_m);
  }
  for (int b = 0; b < col_bands; ++b) {
    const double center = 0.5 * (b * grid.cols / col_bands + (b + 1) * grid.cols / col_bands - 1);
    longitudinal_.lever_m.push_back(center * grid.cell_m - 0.5 * (grid.cols - 1) * grid.cell_m);
  }
  make_profiles(grid.cols, hypotheses.y_m, lateral_);
  make_profiles(grid.rows, hypotheses.x_m, longitudinal_);
}

void BandedMatcher::make_profiles(int length, const HypothesisAxis& axis, Bands& bands) const {
  bands.length = length;
  double lever_m = 0.0;
  for (double lever : bands.lever_m) lever_m = std::max(lever_m, std::abs(lever));
  const double farthest_m = axis.farthest() + lever_m * hypotheses_.yaw_rad.farthest();
  bands.reach = whole_cells(farthest_m, grid_.cell_m) + kCubicTaps / 2;
  const size_t count = bands.lever_m.size();
  bands.bev.resize(count * (length + 2 * bands.reach) * lanes_);
  bands.map.resize(count * length * lanes_);
  bands.correlation.resize(count * (2 * bands.reach + 1));
  bands.scores.resize(static_cast<size_t>(hypotheses_.yaw_rad.count()) * axis.count());
  for (int k = 0; k < hypotheses_.yaw_rad.count(); ++k) {
    for (int i = 0; i < axis.count(); ++i) {
      for (double lever : bands.lever_m) {
        const double shift_m = axis.value(i) + hypotheses_.yaw_rad.value(k) * lever;
        bands.taps.push_back(cubic_taps(shift_m / grid_.cell_m + bands.reach));
      }
    }
  }
}

void BandedMatcher::match(const MatchSide& bev, const MatchSide& map, SolverResult& result) {
  average(bev.cells, lateral_.reach, longitudinal_.reach, lateral_.bev, longitudinal_.bev);
  average(map.cells, 0, 0, lateral_.map, longitudinal_.map);
  for (Bands* bands : {&lateral_, &longitudinal_}) {
    correlate(*bands);
    score(*bands);
  }
  // P(yaw) is proportional to the product of the sums over x and over y.
  const int y_count = hypotheses_.y_m.count();
  const int x_count = hypotheses_.x_m.count();
  for (int k = 0; k < hypotheses_.yaw_rad.count(); ++k) {
    yaw_scores_[k] = normalise(std::span(lateral_.scores).subspan(k * y_count, y_count),
                               parameters_.banded_y_scale) +
                     normalise(std::span(longitudinal_.scores).subspan(k * x_count, x_count),
                               parameters_.banded_x_scale);
  }
  softmax(yaw_scores_, 1.0, result.yaw_probability);
  marginalise(lateral_, result.yaw_probability, result.y_probability);
  marginalise(longitudinal_, result.yaw_probability, result.x_probability);
  result.correction = mean_correction(result, hypotheses_);
}

/// Writes the standardised profiles of all bands. Each profile has `lateral_reach` or
/// `longitudinal_reach` cells of zeros at both ends.
void BandedMatcher::average(const CellFeatures& features, int lateral_reach, int longitudinal_reach,
                            LaneBuffer& lateral, LaneBuffer& longitudinal) const {
  const int row_bands = static_cast<int>(lateral_.lever_m.size());
  const int col_bands = static_cast<int>(longitudinal_.lever_m.size());
  const std::ptrdiff_t lateral_stride =
      static_cast<std::ptrdiff_t>(grid_.cols + 2 * lateral_reach) * lanes_;
  const std::ptrdiff_t longitudinal_stride =
      static_cast<std::ptrdiff_t>(grid_.rows + 2 * longitudinal_reach) * lanes_;
  std::ranges::fill(lateral, 0.0F);
  std::ranges::fill(longitudinal, 0.0F);
  float* lateral_first = lateral.data() + lateral_reach * lanes_;
  float* longitudinal_first = longitudinal.data() + longitudinal_reach * lanes_;
  for (int b = 0; b < row_bands; ++b) {
    const int begin = b * grid_.rows / row_bands;
    const int end = (b + 1) * grid_.rows / row_bands;
    for (int row = begin; row < end; ++row) {
      add_weighted(features.cell(row, 0), 1.0F / static_cast<float>(end - begin),
                   grid_.cols * lanes_, lateral_first + b * lateral_stride);
    }
  }
  for (int row = 0; row < grid_.rows; ++row) {
    for (int b = 0; b < col_bands; ++b) {
      const int begin = b * grid_.cols / col_bands;
      const int end = (b + 1) * grid_.cols / col_bands;
      add_weighted_sum(features.cell(row, begin), end - begin,
                       1.0F / static_cast<float>(end - begin), lanes_,
                       longitudinal_first + b * longitudinal_stride + row * lanes_);
    }
  }
  standardise_runs(lateral_first, row_bands, lateral_stride, grid_.cols, lanes_, kBandStdEpsilon);
  standardise_runs(longitudinal_first, col_bands, longitudinal_stride, grid_.rows, lanes_,
                   kBandStdEpsilon);
}

void BandedMatcher::correlate(Bands& bands) const {
  const int shifts = 2 * bands.reach + 1;
  const auto count = static_cast<double>(bands.lever_m.size()) * bands.length * channels_;
  const std::ptrdiff_t bev_stride =
      static_cast<std::ptrdiff_t>(bands.length + 2 * bands.reach) * lanes_;
  for (size_t b = 0; b < bands.lever_m.size(); ++b) {
    const float* map = bands.map.data() + b * bands.length * lanes_;
    for (int shift = 0; shift < shifts; ++shift) {
      const float* bev = bands.bev.data() + b * bev_stride + shift * lanes_;
      bands.correlation[b * shifts + shift] = dot(map, bev, bands.length * lanes_) / count;
    }
  }
}

void BandedMatcher::score(Bands& bands) {
  const CubicTaps* taps = bands.taps.data();
  const size_t count = bands.lever_m.size();
  const size_t shifts = bands.correlation.size() / count;
  for (double& score : bands.scores) {
    score = 0.0;
    const double* correlation = bands.correlation.data();
    for (size_t b = 0; b < count; ++b, ++taps, correlation += shifts) {
      for (int tap = 0; tap < kCubicTaps; ++tap) {
        score += taps->weight[tap] * correlation[taps->first + tap];
      }
    }
  }
}

/// P(i) = sum over yaw of P(yaw) P(i | yaw).
void BandedMatcher::marginalise(const Bands& bands, std::span<const float> yaw_probability,
                                std::span<float> probability) {
  std::ranges::fill(probability, 0.0F);
  const double* given_yaw = bands.scores.data();
  for (const float yaw : yaw_probability) {
    for (float& p : probability) p += yaw * static_cast<float>(*given_yaw++);
  }
}

}  // namespace bevloc
