#include "pipeline/tracker/match_repetition.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bevloc {
namespace {

/// The squared error of uncertain matches is this multiple of the variance that they state: (along,
/// across, heading). It was measured on 7,214, 460 and 2,814 such matches of 33 drives with two
/// rigs (`bevloc tune matches`).
const Eigen::Vector3d kExcess{2.3, 5.7, 3.3};
/// The approximate correlation between the errors of two such matches that are less than 1.5 m
/// apart. The measured values are 0.10, 0.14 and 0.06.
const Eigen::Vector3d kCorrelation{0.1, 0.15, 0.06};
/// The noise of a match decays by a factor of e over about this distance. In eight drives at a
/// twentieth of the usual speed, two matches shared 52, 33 and 17 % of the noise of their headings
/// if they were 0.05, 0.2 and 0.5 m apart (`bevloc tune matches`, docs/integrity.md).
constexpr double kNoiseLength_m = 0.2;
constexpr int kMostRepeats = 1000;

/// If an error decays by a factor of e over `length_m` (a first-order Gauss-Markov process), the
/// mean of many matches that are `distance_m` apart has the variance of independent ones times
/// (1 + r) / (1 - r) = coth(distance / (2 length)), where r = exp(-distance / length).
/// Returns that factor minus one.
double repeats_after(double distance_m, double length_m) {
  if (length_m <= 0.0) return 0.0;
  const double half = std::max(0.5 * distance_m / length_m, 1.0 / kMostRepeats);
  return 1.0 / std::tanh(half) - 1.0;
}

}  // namespace

void MatchRepetition::discount(Time time, double speed_mps, bool stands,
                               const ErrorCorrelation& correlation, PoseMeasurement& match) {
  const double distance_m = latest_ ? std::abs(speed_mps * to_seconds(time - *latest_))
                                    : std::numeric_limits<double>::infinity();
  const Eigen::Vector3d repeats = correlation.match_m.unaryExpr(
      [distance_m](double length_m) { return repeats_after(distance_m, length_m); });
  const Eigen::Vector3d factor =
      kExcess.cwiseProduct(Eigen::Vector3d::Ones() + kCorrelation.cwiseProduct(repeats));
  match.repeated_variance = match.uncommon_variance.cwiseProduct(factor - Eigen::Vector3d::Ones());
  match.repeated_variance += repeats_of_noise(distance_m, stands) * match.covariance.diagonal();
  latest_ = time;
}

double MatchRepetition::repeats_of_noise(double distance_m, bool stands) {
  standing_matches_ = stands ? std::min(standing_matches_ + 1, kMostRepeats) : 0;
  if (standing_matches_ > 1) return square_of(standing_matches_ - 1);
  return repeats_after(distance_m, kNoiseLength_m);
}

}  // namespace bevloc
