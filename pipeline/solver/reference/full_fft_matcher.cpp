#include "pipeline/solver/reference/full_fft_matcher.h"

#include <algorithm>

#include "pipeline/solver/feature_warp.h"
#include "pipeline/solver/posterior.h"
#include "pipeline/solver/reference/joint_posterior.h"

namespace bevloc {
namespace {

std::vector<SplitShift> split(const HypothesisAxis& axis, double cell_m) {
  std::vector<SplitShift> shifts;
  for (int i = 0; i < axis.count(); ++i) shifts.push_back(split_shift(axis.value(i) / cell_m));
  return shifts;
}

}  // namespace

FullFftMatcher::FullFftMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                               const SolverParameters& parameters)
    : hypotheses_(hypotheses),
      parameters_(parameters),
      grid_(grid),
      channels_(channels),
      shifts_(shift_range(hypotheses, grid.cell_m)),
      row_shifts_(split(hypotheses.x_m, grid.cell_m)),
      col_shifts_(split(hypotheses.y_m, grid.cell_m)),
      shift_correlation_(grid, channels, shifts_),
      shift_energy_(grid, channels, shifts_),
      // One cell more, because ShiftEnergy reads the last cell's neighbour with weight zero.
      frame_(
          (static_cast<size_t>(grid.rows + 2 * shifts_.rows) * (grid.cols + 2 * shifts_.cols) + 1) *
          round_up_to_lanes(channels)),
      correlation_(static_cast<size_t>(shifts_.row_count()) * shifts_.col_count()),
      scores_(hypotheses.count()),
      probability_(hypotheses.count()) {}

void FullFftMatcher::match(const MatchSide& bev, const MatchSide& map, SolverResult& result) {
  map_moments_ = moments_of(map.cells);
  shift_correlation_.set_map(map.cells);
  const size_t slice = scores_.size() / hypotheses_.yaw_rad.count();
  for (int k = 0; k < hypotheses_.yaw_rad.count(); ++k) {
    rotate(bev.cells, hypotheses_.yaw_rad.value(k));
    shift_correlation_.correlate(frame_, correlation_);
    shift_energy_.set_frame(frame_);
    score(std::span(scores_).subspan(k * slice, slice));
  }
  softmax(scores_, parameters_.joint_scale, probability_);
  summarise_joint(probability_, hypotheses_, result);
}

void FullFftMatcher::rotate(const CellFeatures& bev, double yaw_rad) {
  const int rows = grid_.rows + 2 * shifts_.rows;
  const int cols = grid_.cols + 2 * shifts_.cols;
  const FeatureWarp rotated(bev, yaw_rad);
  for (int row = 0; row < rows; ++row) {
    warp(rotated.line(row - shifts_.rows, -shifts_.cols, cols),
         frame_.data() + static_cast<size_t>(row) * cols * bev.lanes());
  }
}

void FullFftMatcher::score(std::span<double> scores) const {
  const double count = static_cast<double>(grid_.cells()) * channels_;
  double* score = scores.data();
  for (const SplitShift& row : row_shifts_) {
    for (const SplitShift& col : col_shifts_) {
      const FeatureMoments moved =
          moments(shift_energy_.value(row, col), shift_energy_.square(row, col), count);
      *score++ = zncc(correlation(row, col), map_moments_, moved, count);
    }
  }
}

/// Interpolates the correlation. It is linear in the features, so this interpolates the features.
double FullFftMatcher::correlation(const SplitShift& row, const SplitShift& col) const {
  const auto at = [this](int m, int n) {
    return correlation_[shifts_.index(std::min(m, shifts_.rows), std::min(n, shifts_.cols))];
  };
  const double upper =
      (1.0 - col.fraction) * at(row.whole, col.whole) + col.fraction * at(row.whole, col.whole + 1);
  const double lower = (1.0 - col.fraction) * at(row.whole + 1, col.whole) +
                       col.fraction * at(row.whole + 1, col.whole + 1);
  return (1.0 - row.fraction) * upper + row.fraction * lower;
}

}  // namespace bevloc
