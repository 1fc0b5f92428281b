// What `bevloc localize` says, as text and as JSON.
#pragma once

#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "common/se2.h"
#include "evaluation/localize/perception_score.h"
#include "evaluation/solver/solver_score.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/solver/solver_result.h"
#include "pipeline/tracker/evidence.h"

namespace bevloc::evaluation {

/// One localization.
struct Localization {
  Se2 prior;
  MatchResult match;                            ///< as judge_single() leaves it
  Seen seen;                                    ///< what the match shows
  bool is_wide = false;                         ///< whether the search was that of --wide
  CameraMask cameras;                           ///< that were used
  std::map<std::string, std::string> left_out;  ///< why each other camera was not
  PerceptionScore perception{};

  Se2 pose() const { return prior * match.correction; }
  /// Whether bevlocd matches framesets with so many cameras, with its default
  /// `cameras.min_cameras`.
  bool has_enough_cameras() const;
  /// Whether bevlocd would take a new pose from matches like this one, and no axis is at the border
  /// of the search.
  bool is_trusted() const {
    return has_enough_cameras() && seen.confirms_start() && !seen.at_border.any();
  }
};

/// The sigma of the pose. An axis at the border of the search has none (kNotGiven), and no axis has
/// one without evidence.
PerAxis sigma_of(const Localization& localization);

/// Judges a match as bevlocd judges one that has none before it. The sigma of an axis with a low
/// score grows, and an axis at the border of the search loses its evidence.
Seen judge_single(MatchResult& match);

/// Localizations from many priors around a known pose.
struct PriorScores {
  std::vector<Outcome> priors;   ///< errors of the priors themselves
  std::vector<Outcome> matches;  ///< their sigmas are those of sigma_of()
  int without_evidence = 0;
  PerceptionScore perception{};  ///< against the map at the known pose
};

std::string text_of(const Localization& localization);
nlohmann::json json_of(const Localization& localization);

std::string text_of(const PriorScores& scores);
nlohmann::json json_of(const PriorScores& scores);

/// The mean error per axis: what remains if the priors' errors average out.
PerAxis bias_of(const std::vector<Outcome>& outcomes);

}  // namespace bevloc::evaluation
