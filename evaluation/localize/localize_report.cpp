#include "evaluation/localize/localize_report.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "drivers/frameset/synchronizer.h"
#include "evaluation/summary_format.h"
#include "pipeline/tracker/measurements.h"

namespace bevloc::evaluation {
namespace {

/// The names of the classes in the order of ElementClass.
constexpr std::array<const char*, kRasterChannels> kClassNames = {"dividers", "crossings",
                                                                  "boundaries"};

std::vector<std::string> names_of(CameraMask cameras) {
  std::vector<std::string> names;
  for (size_t i = 0; i < kCameraCount; ++i) {
    if (cameras[i]) names.emplace_back(kCameraNames[i]);
  }
  return names;
}

std::string lines_of(const PerceptionScore& perception) {
  std::string text =
      fmt::format("perceived within {} m      recall  precision\n", kPerceivedWithin_m);
  for (size_t i = 0; i < perception.size(); ++i) {
    const ClassScore& score = perception[i];
    text += fmt::format("  {:22} {:>8} {:>10}\n", kClassNames[i],
                        score.mapped > 0 ? fmt::format("{:.2f}", score.recall) : "not mapped",
                        score.perceived > 0 ? fmt::format("{:.2f}", score.precision) : "none seen");
  }
  return text;
}

nlohmann::json json_of(const PerceptionScore& perception) {
  nlohmann::json json;
  for (size_t i = 0; i < perception.size(); ++i) {
    const ClassScore& score = perception[i];
    nlohmann::json& entry = json[kClassNames[i]];
    entry = {{"recall", nullptr}, {"precision", nullptr}};
    if (score.mapped > 0) entry["recall"] = score.recall;
    if (score.perceived > 0) entry["precision"] = score.precision;
  }
  return json;
}

/// bevlocd drops a frameset with fewer cameras.
constexpr int kFewestCameras = drivers::SynchronizerConfig().min_cameras;

constexpr std::array<const char*, 3> kAxes = {"along", "across", "yaw"};
constexpr std::array<const char*, 3> kUnits = {"m", "m", "degrees"};

template <typename Vector>
std::array<typename Vector::Scalar, 3> listed(const Vector& values) {
  return {values(0), values(1), values(2)};
}

/// The number of outcomes without a sigma, per axis.
std::array<int, 3> without_sigma(const std::vector<Outcome>& outcomes) {
  std::array<int, 3> count{};
  for (const Outcome& outcome : outcomes) {
    for (size_t axis = 0; axis < count.size(); ++axis) {
      count[axis] += std::isnan(outcome.sigma[axis]) ? 1 : 0;
    }
  }
  return count;
}

std::string border_lines_of(const Localization& localization) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    if (!localization.seen.at_border(axis)) continue;
    text += fmt::format(
        "{}: the best place is at the border of the search, so the truth may lie outside of it; "
        "give a better prior{}\n",
        kAxes[static_cast<size_t>(axis)], localization.is_wide ? "" : " or use --wide");
  }
  return text;
}

std::string trust_line_of(const Localization& localization) {
  if (localization.is_trusted()) return "trusted: yes\n";
  const Seen& seen = localization.seen;
  std::vector<std::string> reasons;
  if (!localization.has_enough_cameras()) {
    reasons.push_back(fmt::format("fewer than {} cameras were used", kFewestCameras));
  }
  if (!seen.place) reasons.emplace_back("the score is too low");
  if (seen.at_border.any()) reasons.emplace_back("the best place is at the border");
  if (!seen.across && !seen.at_border.y()) {
    reasons.emplace_back("the lines do not show the place across");
  }
  if (!seen.heading && !seen.at_border.z()) {
    reasons.emplace_back("the lines do not show the yaw");
  }
  if (!seen.unique) reasons.emplace_back("two places across look alike");
  return fmt::format("trusted: no, because {}\n", fmt::join(reasons, ", "));
}

}  // namespace

bool Localization::has_enough_cameras() const {
  return static_cast<int>(cameras.count()) >= kFewestCameras;
}

PerAxis sigma_of(const Localization& localization) {
  if (localization.match.evidence == Evidence::kNone) return {kNotGiven, kNotGiven, kNotGiven};
  PerAxis sigma = in_units(pose_sigma(localization.match));
  for (int axis = 0; axis < 3; ++axis) {
    if (localization.seen.at_border(axis)) sigma[static_cast<size_t>(axis)] = kNotGiven;
  }
  return sigma;
}

Seen judge_single(MatchResult& match) {
  const Seen seen = EvidenceMonitor::judge_alone(match);
  forget_border(seen, match);
  return seen;
}

std::string text_of(const Localization& localization) {
  const MatchResult& match = localization.match;
  std::string text = fmt::format("cameras: {}\n", fmt::join(names_of(localization.cameras), ", "));
  if (match.evidence == Evidence::kNone) {
    return text + "no evidence: the pictures or the map show nothing to match\n" +
           lines_of(localization.perception);
  }
  const PerAxis pose = in_units(localization.pose());
  const PerAxis correction = in_units(match.correction);
  const PerAxis sigma = sigma_of(localization);
  text += fmt::format("pose: x {:.3f} m, y {:.3f} m, yaw {:.3f} degrees in the map\n", pose[0],
                      pose[1], pose[2]);
  text += "axis            correction     sigma  evidence     score\n";
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<size_t>(axis);
    text += fmt::format("{:14} {:+11.3f} {:>9} {:9.2f} {:9.2f}\n",
                        fmt::format("{}, {}", kAxes[at], kUnits[at]), correction[at],
                        number_or_dash(sigma[at], 3), match.evidence_share(axis),
                        match.axis_score(axis));
  }
  text += fmt::format("score of the whole match: {:.2f} (bevlocd tracks from {:.2f})\n",
                      match.score, EvidenceMonitor::kMinScore);
  text += border_lines_of(localization) + trust_line_of(localization);
  return text + lines_of(localization.perception);
}

nlohmann::json json_of(const Localization& localization) {
  const MatchResult& match = localization.match;
  nlohmann::json json{{"cameras", names_of(localization.cameras)},
                      {"cameras_left_out", localization.left_out},
                      {"prior", in_units(localization.prior)},
                      {"evidence", match.evidence == Evidence::kGood},
                      {"trusted", localization.is_trusted()},
                      {"perception", json_of(localization.perception)}};
  for (const char* key : {"pose", "correction", "sigma", "evidence_share", "axis_score", "score",
                          "at_border", "rival_peak"}) {
    json[key] = nullptr;
  }
  if (match.evidence == Evidence::kNone) return json;
  json["pose"] = in_units(localization.pose());
  json["correction"] = in_units(match.correction);
  json["sigma"] = sigma_of(localization);
  json["evidence_share"] = listed(match.evidence_share);
  json["axis_score"] = listed(match.axis_score);
  json["rival_peak"] = listed(match.rival_peak);
  json["at_border"] = listed(localization.seen.at_border);
  json["score"] = match.score;
  return json;
}

PerAxis bias_of(const std::vector<Outcome>& outcomes) {
  PerAxis bias{};
  for (const Outcome& outcome : outcomes) {
    for (size_t axis = 0; axis < bias.size(); ++axis) {
      bias[axis] += outcome.error[axis] / static_cast<double>(outcomes.size());
    }
  }
  return bias;
}

std::string text_of(const PriorScores& scores) {
  const Summary prior = summarise(scores.priors);
  const Summary match = summarise(scores.matches);
  const auto missing = without_sigma(scores.matches);
  return fmt::format(
      "{} priors, {} without evidence; along, across (m), yaw (degrees)\n"
      "prior, mean absolute error      {}\n"
      "bevloc, mean absolute error     {}\n"
      "bevloc, mean error (bias)       {}\n"
      "bevloc, errors within 3 sigma, % {}\n"
      "bevloc, answers without a sigma {:>4} {:>3} {:>3}\n{}",
      scores.priors.size(), scores.without_evidence, three(prior.mae), three(match.mae),
      three(bias_of(scores.matches)), percent(match.coverage_3s), missing[0], missing[1],
      missing[2], lines_of(scores.perception));
}

nlohmann::json json_of(const PriorScores& scores) {
  return {{"priors", scores.priors.size()},
          {"without_evidence", scores.without_evidence},
          {"prior", json_of(summarise(scores.priors))},
          {"bevloc", json_of(summarise(scores.matches))},
          {"bias", bias_of(scores.matches)},
          {"without_sigma", without_sigma(scores.matches)},
          {"perception", json_of(scores.perception)}};
}

}  // namespace bevloc::evaluation
