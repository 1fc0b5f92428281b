#include "pipeline/solver/reference/translation_scorer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/target_clones.h"
#include "pipeline/solver/feature_warp.h"
#include "pipeline/solver/shift_range.h"

namespace bevloc {
namespace {

BEVLOC_TARGET_CLONES MatchSums match_row(const float* map, const float* moved, int count) {
  LaneSums sums[2];
  int i = 0;
  for (; i + 2 * kLanes <= count; i += 2 * kLanes) {
    for (int k = 0; k < 2; ++k) {
      sums[k].add(lanes(map + i + k * kLanes), lanes(moved + i + k * kLanes));
    }
  }
  if (i < count) sums[0].add(lanes(map + i), lanes(moved + i));
  return sum_of(sums[0], sums[1]);
}

}  // namespace

ShiftPlan::ShiftPlan(const HypothesisAxis& axis, double cell_m) : hypotheses_(axis.count()) {
  for (int i = 0; i < axis.count(); ++i) {
    const auto [cells, fraction] = split_shift(axis.value(i) / cell_m);
    const auto phase =
        std::ranges::find_if(phases_, [&, fraction = fraction](const Phase& candidate) {
          return std::abs(candidate.fraction - fraction) < kWholeShiftTolerance;
        });
    if (phase != phases_.end()) {
      phase->shifts.push_back({cells, i});
    } else {
      phases_.push_back({fraction, {{cells, i}}});
    }
  }
}

TranslationScorer::TranslationScorer(const BevGrid& grid, int channels,
                                     const HypothesisGrid& hypotheses)
    : sums_(static_cast<size_t>(hypotheses.x_m.count()) * hypotheses.y_m.count()) {
  const int widest =
      grid.cols + static_cast<int>(2.0 * hypotheses.y_m.farthest() / grid.cell_m) + 2;
  warped_row_.resize(static_cast<size_t>(widest) * round_up_to_lanes(channels));
}

void TranslationScorer::set_features(const CellFeatures& bev, const CellFeatures& map) {
  bev_ = &bev;
  map_ = &map;
  map_moments_ = moments_of(map);
}

void TranslationScorer::score(double yaw_rad, const ShiftPlan& x, const ShiftPlan& y,
                              std::span<double> scores) {
  assert(scores.size() == static_cast<size_t>(x.hypotheses()) * y.hypotheses());
  for (const auto& x_phase : x.phases()) {
    for (const auto& y_phase : y.phases()) {
      match_phase(yaw_rad, x_phase, y_phase);
      const MatchSums* sums = sums_.data();
      for (const auto& x_shift : x_phase.shifts) {
        for (const auto& y_shift : y_phase.shifts) {
          scores[x_shift.hypothesis * y.hypotheses() + y_shift.hypothesis] = score_of(*sums++);
        }
      }
    }
  }
}

void TranslationScorer::match_phase(double yaw_rad, const ShiftPlan::Phase& x,
                                    const ShiftPlan::Phase& y) {
  const BevGrid& grid = map_->grid();
  const int lanes = map_->lanes();
  std::fill_n(sums_.begin(), x.shifts.size() * y.shifts.size(), MatchSums{});
  const FeatureWarp moved(*bev_, yaw_rad, x.fraction, y.fraction);
  const int col_begin = y.shifts.front().cells;
  const int cells = grid.cols + y.shifts.back().cells - col_begin;
  const int row_end = grid.rows + x.shifts.back().cells;
  for (int row = x.shifts.front().cells; row < row_end; ++row) {
    warp(moved.line(row, col_begin, cells), warped_row_.data());
    MatchSums* sums = sums_.data();
    for (const auto& x_shift : x.shifts) {
      const int map_row = row - x_shift.cells;
      const bool inside = map_row >= 0 && map_row < grid.rows;
      for (size_t j = 0; inside && j < y.shifts.size(); ++j) {
        const float* shifted = warped_row_.data() + (y.shifts[j].cells - col_begin) * lanes;
        sums[j] += match_row(map_->cell(map_row, 0), shifted, grid.cols * lanes);
      }
      sums += y.shifts.size();
    }
  }
}

double TranslationScorer::score_of(const MatchSums& sums) const {
  const double count = static_cast<double>(map_->grid().cells()) * map_->channels();
  return zncc(sums, map_moments_, count);
}

}  // namespace bevloc
