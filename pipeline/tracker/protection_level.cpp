#include "pipeline/tracker/protection_level.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/normal_distribution.h"
#include "common/se2.h"

namespace bevloc {
namespace {

/// A wrong place lies anywhere within this distance: (m, m, rad).
const Eigen::Vector3d kWrongWithin{10.0, 10.0, radians(10.0)};
/// How often the match settles on a wrong place without any other sign.
constexpr double kWrongPlaceRate_per_s = 1e-9;
/// The search for the protection level begins at this many sigmas. An error beyond them is rarer
/// than any integrity risk.
constexpr double kBeyondAnyRisk = 8.0;
constexpr int kBisections = 30;

/// How much better a wrong place than the right place explains the normalised GNSS error of an
/// axis.
double likelihood_ratio(double error, double sigma, double wrong_within) {
  const double density_right = std::exp(-0.5 * error * error) / std::sqrt(2.0 * std::numbers::pi);
  const double density_wrong = sigma / (2.0 * wrong_within);
  return density_wrong / std::max(density_right, 1e-300);
}

double probability_of_wrong_place(const std::optional<GnssView>& gnss, double exposure_s) {
  double odds = kWrongPlaceRate_per_s * exposure_s;
  if (gnss) {
    double best = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!gnss->sees(axis)) continue;
      best = std::max(best,
                      likelihood_ratio(gnss->error(axis), gnss->sigma(axis), kWrongWithin(axis)));
    }
    odds *= best;
  }
  return odds / (1.0 + odds);
}

/// The error of one axis as a mixture of the right and a wrong place.
struct AxisMixture {
  double sigma = 1.0;
  double wrong = 0.0;  ///< probability
  bool bounded = false;
  double wrong_mean = 0.0;
  double wrong_sigma = 1.0;
  double wrong_within = 1.0;

  double probability_beyond(double level) const {
    const double right = 2.0 * upper_tail(level / sigma);
    const double misplaced = bounded ? upper_tail((level - wrong_mean) / wrong_sigma) +
                                           upper_tail((level + wrong_mean) / wrong_sigma)
                                     : std::max(0.0, 1.0 - level / wrong_within);
    return (1.0 - wrong) * right + wrong * misplaced;
  }
};

double quantile(const AxisMixture& mixture, double risk) {
  double low = 0.0;
  double high = kBeyondAnyRisk * mixture.sigma;
  high = std::max(high, mixture.bounded
                            ? std::abs(mixture.wrong_mean) + kBeyondAnyRisk * mixture.wrong_sigma
                            : mixture.wrong_within);
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (mixture.probability_beyond(middle) > risk ? low : high) = middle;
  }
  return high;
}

}  // namespace

Eigen::Vector3d protection_level(const Eigen::Vector3d& sigma, const std::optional<GnssView>& gnss,
                                 double exposure_s, const ProtectionParameters& parameters) {
  const double wrong = probability_of_wrong_place(gnss, exposure_s);
  Eigen::Vector3d level;
  for (int axis = 0; axis < 3; ++axis) {
    AxisMixture mixture;
    mixture.sigma = parameters.tail_factor * sigma(axis);
    mixture.wrong = wrong;
    mixture.wrong_within = kWrongWithin(axis);
    if (gnss && gnss->sees(axis)) {
      mixture.bounded = true;
      mixture.wrong_mean = gnss->error(axis) * gnss->sigma(axis);
      mixture.wrong_sigma = gnss->sigma(axis);
    }
    level(axis) = quantile(mixture, parameters.integrity_risk);
  }
  return level;
}

}  // namespace bevloc
