// The modelled matcher: answers like network and solver, with errors that were measured on
// pictures.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "evaluation/campaign/match_table.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/solver_result.h"
#include "sim/random.h"

namespace bevloc::evaluation {

/// The true motion of the vehicle at a frameset.
struct MatchedPlace {
  double distance_m = 0.0;  ///< driven since the start of the drive
  double curvature_radpm = 0.0;
};

/// Replays measured matches in blocks of 30 to 90 m of driving. A block keeps the bias of the
/// matches, their correlation over distance, and stretches where they see nothing along the road. A
/// turning vehicle gets a block that begins where the measured vehicle turned; the same holds for a
/// vehicle that drives straight. A vehicle that stands, or drives so slowly that it stays at one
/// measured place, gets that place's match with the scatter that pictures of one place have.
///
/// Among the matches of a place and its neighbours, the model takes the one whose prior had the
/// most similar error. If the truth is near the border of the search range or beyond it, the model
/// thus gives the same confident but wrong answer that was measured there. One thread.
class MatchModel {
 public:
  /// `table` must outlive the model. Each of its drives must have matches of both ranges.
  MatchModel(const MatchTable& table, const HypothesisGrid& tracking,
             const HypothesisGrid& acquiring, uint64_t seed);

  /// The match of a frameset from the prior T0; `truth` is the correction that leads from T0 to the
  /// true pose. The distance must not decrease from call to call.
  MatchResult match(const MatchedPlace& place, SearchRange range, const Se2& truth);

  /// The match of a frameset that finds a place `offset` beside the true one: as exact as at the
  /// right place, with the scores that were measured that far beside it.
  MatchResult match_beside(const MatchedPlace& place, SearchRange range, const Se2& truth,
                           const Se2& offset);

  const HypothesisGrid& hypotheses(SearchRange range) const {
    return range == SearchRange::kTracking ? tracking_ : acquiring_;
  }

 private:
  void collect_scatter();
  void follow(const MatchedPlace& place);
  void begin_block(const MatchedPlace& place);
  const MeasuredMatch& most_alike(SearchRange range, const Se2& truth) const;
  /// Of the places at most `reach` before and after this one; null if none has such a match.
  const MeasuredMatch* most_alike_within(size_t reach, SearchRange range, const Se2& truth) const;
  const MeasuredMatch& beside(const Se2& offset) const;

  const MatchTable& table_;
  HypothesisGrid tracking_;
  HypothesisGrid acquiring_;
  sim::Random random_;
  std::vector<Se2> scatter_;                   ///< of matches at one place
  std::array<std::vector<size_t>, 2> starts_;  ///< places of straight and of turning vehicles
  size_t at_ = 0;                              ///< the measured place of the latest frameset
  double offset_m_ = 0.0;      ///< the station of the place minus the distance of the vehicle
  double block_end_m_ = -1.0;  ///< distance of the simulated vehicle
  bool repeated_ = false;      ///< the latest two framesets have the same measured place
};

}  // namespace bevloc::evaluation
