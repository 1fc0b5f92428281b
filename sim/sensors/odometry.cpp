#include "sim/sensors/odometry.h"

#include <cassert>
#include <cmath>

#include "sim/random.h"

namespace bevloc::sim {
namespace {

constexpr double kSpeedScaleSigma = 0.01;
constexpr double kSpeedWhite_mps = 0.03;
constexpr double kYawRateBias_radps = radians(0.1);
constexpr double kYawRateBiasWalk = radians(0.003);  ///< random walk, rad/s per sqrt(s)
constexpr double kYawRateWhite_radps = radians(0.1);

}  // namespace

OdometrySimulator::OdometrySimulator(const Drive& drive, uint64_t seed) : drive_(drive) {
  Random random(seed_for(seed, "odometry"));
  speed_scale_ = random.normal(1.0, kSpeedScaleSigma);
  double bias = random.normal(0.0, kYawRateBias_radps);
  const auto readings = static_cast<size_t>(drive.duration_s() / kPeriod_s) + 1;
  errors_.resize(readings);
  for (Error& error : errors_) {
    error.speed_mps = random.normal(0.0, kSpeedWhite_mps);
    error.yaw_rate_radps = bias + random.normal(0.0, kYawRateWhite_radps);
    bias += random.normal(0.0, kYawRateBiasWalk * std::sqrt(kPeriod_s));
  }
}

OdometryReading OdometrySimulator::reading(size_t index) const {
  assert(index < errors_.size());
  const double time_s = static_cast<double>(index) * kPeriod_s;
  const Drive::State truth = drive_.at(time_s);
  return {time_s, speed_scale_ * truth.speed_mps + errors_[index].speed_mps,
          truth.yaw_rate_radps + errors_[index].yaw_rate_radps};
}

}  // namespace bevloc::sim
