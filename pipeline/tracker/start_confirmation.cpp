#include "pipeline/tracker/start_confirmation.h"

#include <algorithm>
#include <cmath>

namespace bevloc {
namespace {

/// A match with this score tells nothing about the place. The right place mostly has a higher
/// score, and a wrong place has a lower one.
constexpr double kNeutralScore = 0.18;
/// The neutral score along the road. Where nothing crosses the road, the right place may have a
/// score as low as that of a wrong place.
constexpr double kNeutralAlongScore = 0.14;
/// Weight of the square of a score beyond the neutral one. Wrong places hardly ever have scores far
/// beyond it.
constexpr double kSquareWeight = 20.0;
/// The support that a start needs where GNSS agrees, and how much more it needs for each squared
/// standard deviation of the GNSS error.
constexpr double kNeeded = 0.5;
constexpr double kNeededPerSquaredSigma = 4.0;
/// After this many further matches, the support of a match has fallen to about a third. A wrong
/// lane has good scores for a while, and they should not count for long.
constexpr double kMemory_matches = 100.0;
/// Matches that may count for each metre driven.
constexpr double kMatchesPerMetre = 1.0;
/// The distance driven between two samples of odometry counts for at most this time.
constexpr double kLongestStep_s = 0.5;

/// The support of a score that is `beyond` the neutral one.
double support_of(double beyond) {
  return beyond > 0.0 ? beyond + kSquareWeight * beyond * beyond : 0.0;
}

}  // namespace

void StartConfirmation::add(const OdometrySample& odometry) {
  if (odometry_time_) {
    const double step_s = std::min(to_seconds(odometry.time - *odometry_time_), kLongestStep_s);
    const double driven_m = std::abs(odometry.speed_mps) * std::max(step_s, 0.0);
    countable_ = std::min(countable_ + kMatchesPerMetre * driven_m, kMostMatches);
  }
  odometry_time_ = odometry.time;
}

void StartConfirmation::add(const StartMatch& match) {
  if (countable_ < 1.0) return;
  countable_ -= 1.0;
  support_ *= 1.0 - 1.0 / kMemory_matches;
  const double beyond = match.score - kNeutralScore;
  support_ = std::max(support_ + std::min(beyond, 0.0), 0.0);
  if (match.sees) {
    support_ += support_of(beyond) / match.along_growth +
                support_of(match.along_score - kNeutralAlongScore);
  }
}

void StartConfirmation::reset() {
  support_ = 0.0;
  countable_ = kMostMatches;
}

bool StartConfirmation::confirms(const Eigen::Vector3d& gnss_error, double gnss_sigma_m) const {
  const double farthest =
      gnss_error.head<2>().cwiseAbs().maxCoeff() * std::min(gnss_sigma_m / kLeastGnssSigma_m, 1.0);
  return support_ >= kNeeded + kNeededPerSquaredSigma * farthest * farthest;
}

}  // namespace bevloc
