// Scores all translations of one yaw by zero-padded ZNCC.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/match_sums.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {

/// The hypotheses of one axis, grouped by their fraction of a cell. Hypotheses with the same
/// fraction (a phase) differ by whole cells, so they share one warp without loss.
class ShiftPlan {
 public:
  struct Shift {
    int cells = 0;       ///< whole cells, in addition to the phase's fraction
    int hypothesis = 0;  ///< index on the axis
  };
  struct Phase {
    double fraction = 0.0;
    std::vector<Shift> shifts;  ///< increasing
  };

  ShiftPlan(const HypothesisAxis& axis, double cell_m);

  const std::vector<Phase>& phases() const { return phases_; }
  int hypotheses() const { return hypotheses_; }

 private:
  std::vector<Phase> phases_;
  int hypotheses_;
};

/// Scores corrections by ZNCC over all cells and channels (paper, eq. 5). The moved BEV features
/// are zero outside their grid. Each warped row is matched while it is in the cache, and then
/// overwritten. The constructor allocates all memory. One thread.
class TranslationScorer {
 public:
  TranslationScorer(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses);

  /// Sets the features that score() compares. They must outlive all calls of score().
  void set_features(const CellFeatures& bev, const CellFeatures& map);

  /// Writes scores[i * y.hypotheses() + j] of hypothesis i of `x` and j of `y`, all with this yaw.
  void score(double yaw_rad, const ShiftPlan& x, const ShiftPlan& y, std::span<double> scores);

 private:
  void match_phase(double yaw_rad, const ShiftPlan::Phase& x, const ShiftPlan::Phase& y);
  double score_of(const MatchSums& sums) const;

  const CellFeatures* bev_ = nullptr;
  const CellFeatures* map_ = nullptr;
  FeatureMoments map_moments_;
  std::vector<MatchSums> sums_;  ///< [shift of the x phase, shift of the y phase]
  LaneBuffer warped_row_;
};

}  // namespace bevloc
