// What the matches said about the pose so far.
#pragma once

#include <optional>
#include <utility>

#include "common/time.h"
#include "pipeline/tracker/pose_estimator.h"

namespace bevloc::firmware {

/// Counts what the estimator accepts and refuses. One thread.
class MatchHistory {
 public:
  /// Matches with a longer pause between them are not in a row.
  static constexpr Duration kLongestPause = std::chrono::seconds(2);

  /// Adds the outcome of the match of a frameset.
  void add(Time frame_time, const PoseEstimator::MatchOutcome& outcome) {
    const Seen& seen = outcome.seen;
    if (accepted_time_ && frame_time - *accepted_time_ > kLongestPause) accepted_in_a_row_ = 0;
    wide_search_ = seen.at_border.any();
    if (outcome.update == TrackerUpdate::kAccepted) {
      accepted_time_ = unsent_time_ = frame_time;
      if (seen.confirms()) confirmed_time_ = frame_time;
      accepted_in_a_row_ = seen.confirms_start() ? accepted_in_a_row_ + 1 : 0;
      refused_in_a_row_ = 0;
    } else if (is_refused(outcome.update)) {
      accepted_in_a_row_ = 0;
      ++refused_in_a_row_;
    }
  }

  /// Forgets everything, because the matches say nothing about the next pose.
  void forget() { *this = {}; }

  /// Sets the counts to zero, because the pose is lost.
  void restart_counts() { accepted_in_a_row_ = refused_in_a_row_ = 0; }

  /// Frameset of the latest accepted match.
  const std::optional<Time>& accepted_time() const { return accepted_time_; }
  /// Frameset of the latest accepted match that confirms the pose (Seen::confirms()).
  const std::optional<Time>& confirmed_time() const { return confirmed_time_; }
  /// Number of accepted matches in a row that confirm a start (Seen::confirms_start()).
  int accepted_in_a_row() const { return accepted_in_a_row_; }
  int refused_in_a_row() const { return refused_in_a_row_; }
  /// Whether the pose may lie outside the tracking range of the latest match.
  bool wide_search() const { return wide_search_; }

  /// Frameset of an accepted match that no published pose contains yet. Forgets it.
  std::optional<Time> take_unsent() { return std::exchange(unsent_time_, std::nullopt); }

 private:
  /// Whether this answer speaks against the match. A match without evidence says nothing, and
  /// nobody compares a match with a pose if there is none of its time.
  static bool is_refused(TrackerUpdate update) {
    return update == TrackerUpdate::kGated || update == TrackerUpdate::kNotFinite ||
           update == TrackerUpdate::kImplausible;
  }

  std::optional<Time> accepted_time_;
  std::optional<Time> confirmed_time_;
  std::optional<Time> unsent_time_;
  int accepted_in_a_row_ = 0;
  int refused_in_a_row_ = 0;
  bool wide_search_ = false;
};

}  // namespace bevloc::firmware
