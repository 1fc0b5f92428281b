#include "pipeline/tracker/evidence.h"

#include <algorithm>

namespace bevloc {
namespace {

/// Weight of a new score in the mean: about the last half second.
constexpr double kGain = 0.2;
/// Largest probability near the border of the search range. If it is larger, the truth may lie
/// outside, and the answer on this axis is worth nothing.
constexpr double kMaxEdgeMass = 0.25;
/// The match must have removed this share of the variance of the search range.
constexpr double kMinShare = 0.5;
/// A second peak this high means two places that look alike.
constexpr double kMaxRivalPeak = 0.7;
/// If the score of an axis is below this, its answer often belongs to another place along the
/// axis. Its standard deviation is then multiplied by kGoodAxisScore / score, at most by
/// kMaxGrowth.
constexpr double kGoodAxisScore = 0.12;

}  // namespace

Seen EvidenceMonitor::judge(MatchResult& match) {
  const bool has_evidence = match.evidence == Evidence::kGood;
  mean_score_ += kGain * ((has_evidence ? match.score : 0.0) - mean_score_);
  Seen seen = judge_alone(match);
  seen.place = has_evidence && mean_score_ >= kMinScore;
  return seen;
}

Seen EvidenceMonitor::judge_alone(MatchResult& match) {
  Seen seen;
  if (match.evidence != Evidence::kGood) return seen;
  for (int axis = 0; axis < 3; ++axis) {
    const double growth = growth_of(match.axis_score(axis));
    match.covariance.row(axis) *= growth;
    match.covariance.col(axis) *= growth;
    seen.at_border(axis) = match.edge_mass(axis) > kMaxEdgeMass;
  }
  const auto is_seen = [&](int axis) {
    return !seen.at_border(axis) && match.evidence_share(axis) >= kMinShare;
  };
  seen.across = is_seen(1);
  seen.heading = is_seen(2);
  seen.unique = match.rival_peak.y() <= kMaxRivalPeak;
  seen.place = match.score >= kMinScore;
  return seen;
}

double EvidenceMonitor::growth_of(double axis_score) {
  return std::clamp(kGoodAxisScore / std::max(axis_score, 1e-6), 1.0, kMaxGrowth);
}

void forget_border(const Seen& seen, MatchResult& match) {
  match.evidence_share =
      seen.at_border.select(Eigen::Array3d::Zero(), match.evidence_share.array());
}

}  // namespace bevloc
