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

namespace bevloc::evaluation {

/// One localization.
struct Localization {
  Se2 prior;
  MatchResult match;
  CameraMask cameras;                           ///< that were used
  std::map<std::string, std::string> left_out;  ///< why each other camera was not
  PerceptionScore perception{};

  Se2 pose() const { return prior * match.correction; }
};

/// Localizations from many priors around a known pose.
struct PriorScores {
  std::vector<Outcome> priors;  ///< errors of the priors themselves
  std::vector<Outcome> matches;
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
