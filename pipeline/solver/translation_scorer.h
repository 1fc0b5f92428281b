// Zero-padded ZNCC of the moved vehicle features with the map features.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/match_sums.h"
#include "pipeline/solver/solver.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {

/// The hypotheses of one axis, sorted by their fraction of a cell: those of equal fraction (a
/// phase) differ by whole cells, so one warp serves them all, exactly.
class ShiftPlan {
 public:
  struct Shift {
    int cells = 0;       ///< whole cells beyond the phase's fraction
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

/// Scores corrections by ZNCC over all cells and channels (paper, eq. 5), with zeros where the
/// moved vehicle features do not reach. A warped row is matched while it is in the cache and never
/// kept.
class TranslationScorer {
 public:
  TranslationScorer(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses);

  /// Features of the scores to come; they must outlive them.
  void set_features(const CellFeatures& bev, const CellFeatures& map);

  /// scores[i * y.hypotheses() + j] of shift i along x and j along y, all with this yaw.
  void score(double yaw_rad, const ShiftPlan& x, const ShiftPlan& y, std::span<double> scores);

 private:
  void match_phase(double yaw_rad, const ShiftPlan::Phase& x, const ShiftPlan::Phase& y);
  double score_of(const MatchSums& sums) const;

  const CellFeatures* bev_ = nullptr;
  const CellFeatures* map_ = nullptr;
  FeatureMoments map_moments_;
  std::vector<MatchSums> sums_;  ///< [shifts of the x phase, shifts of the y phase]
  LaneBuffer warped_row_;
};

}  // namespace bevloc
