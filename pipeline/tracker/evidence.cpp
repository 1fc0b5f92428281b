#include "pipeline/tracker/evidence.h"

#include <algorithm>

namespace bevloc {
namespace {

/// Weight of a new score in the mean: about the last half second.
constexpr double kGain = 0.2;

}  // namespace

Seen EvidenceMonitor::judge(MatchResult& match) {
  if (match.evidence != Evidence::kGood) {
    mean_score_ -= kGain * mean_score_;
    return {};
  }
  mean_score_ += kGain * (match.score - mean_score_);
  Seen seen;
  for (int axis = 0; axis < 3; ++axis) {
    const double growth = std::clamp(
        limits_.good_axis_score / std::max(match.axis_score(axis), 1e-6), 1.0, limits_.max_growth);
    match.covariance.row(axis) *= growth;
    match.covariance.col(axis) *= growth;
    if (match.edge_mass(axis) <= limits_.max_edge_mass) continue;
    match.evidence_share(axis) = 0.0;
    seen.at_edge = true;
  }
  seen.across = match.evidence_share.y() >= limits_.min_share;
  seen.heading = match.evidence_share.z() >= limits_.min_share;
  seen.unique = match.rival_peak.y() <= limits_.max_rival_peak;
  seen.place = mean_score_ >= limits_.min_score;
  seen.clear = mean_score_ >= limits_.min_start_score;
  return seen;
}

}  // namespace bevloc
