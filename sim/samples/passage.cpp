#include "sim/samples/passage.h"

namespace bevloc::sim {
namespace {

constexpr double kSlowest_mps = 5.0;
constexpr double kFastest_mps = 20.0;
constexpr double kLateralAccelerationSigma_mps2 = 1.0;

// The odometry errors that remain after the tracker has estimated scale and bias.
constexpr double kSpeedScaleSigma = 0.004;
constexpr double kYawRateSigma_radps = radians(0.15);

}  // namespace

Passage::Passage(const Desynchronisation& desynchronisation, uint64_t seed)
    : desynchronisation_(desynchronisation), random_(seed) {
  true_rates_.speed_mps = random_.uniform(kSlowest_mps, kFastest_mps);
  true_rates_.yaw_rate_radps =
      random_.normal(0.0, kLateralAccelerationSigma_mps2) / true_rates_.speed_mps;
  Random odometry(seed_for(seed, "odometry"));
  known_rates_.speed_mps = true_rates_.speed_mps * odometry.normal(1.0, kSpeedScaleSigma);
  known_rates_.yaw_rate_radps =
      true_rates_.yaw_rate_radps + odometry.normal(0.0, kYawRateSigma_radps);
}

double Passage::next_offset_s() {
  return random_.uniform(-desynchronisation_.spread_s, desynchronisation_.spread_s);
}

Se2 Passage::true_motion(double offset_s) const {
  return arc_motion(true_rates_.speed_mps, true_rates_.yaw_rate_radps, offset_s);
}

Se2 Passage::known_motion(double offset_s) const {
  if (!desynchronisation_.compensated) return {};
  return arc_motion(known_rates_.speed_mps, known_rates_.yaw_rate_radps, offset_s);
}

}  // namespace bevloc::sim
