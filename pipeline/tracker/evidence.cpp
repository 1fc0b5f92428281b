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
    const double growth = growth_of(match.axis_score(axis));
    match.covariance.row(axis) *= growth;
    match.covariance.col(axis) *= growth;
    seen.at_border(axis) = match.edge_mass(axis) > limits_.max_edge_mass;
  }
  const auto is_seen = [&](int axis) {
    return !seen.at_border(axis) && match.evidence_share(axis) >= limits_.min_share;
  };
  seen.across = is_seen(1);
  seen.heading = is_seen(2);
  seen.unique = match.rival_peak.y() <= limits_.max_rival_peak;
  seen.place = mean_score_ >= limits_.min_score;
  return seen;
}

double EvidenceMonitor::growth_of(double axis_score) const {
  return std::clamp(limits_.good_axis_score / std::max(axis_score, 1e-6), 1.0, limits_.max_growth);
}

void forget_border(const Seen& seen, MatchResult& match) {
  match.evidence_share =
      seen.at_border.select(Eigen::Array3d::Zero(), match.evidence_share.array());
}

}  // namespace bevloc
