#include "sim/sensors/odometry.h"

#include <cassert>
#include <cmath>

#include "sim/random.h"

namespace bevloc::sim {
namespace {

constexpr double kOdometryScaleSigma = 0.01;
constexpr double kSpeedWhite_mps = 0.03;
constexpr double kYawRateBias_radps = radians(0.1);
constexpr double kYawRateBiasWalk = radians(0.003);  ///< random walk, rad/s per sqrt(s)
constexpr double kYawRateWhite_radps = radians(0.1);
constexpr double kRadiusDifference = 0.003;

}  // namespace

OdometrySimulator::OdometrySimulator(const Drive& drive, uint64_t seed) : drive_(drive) {
  Random random(seed_for(seed, "odometry"));
  speed_scale_ = random.normal(1.0, kOdometryScaleSigma);
  Random wheels(seed_for(seed, "wheels"));
  radius_difference_ = wheels.normal(0.0, kRadiusDifference);
  double bias = random.normal(0.0, kYawRateBias_radps);
  const auto readings = static_cast<size_t>(drive.duration_s() / kPeriod_s) + 1;
  errors_.resize(readings);
  for (Error& error : errors_) {
    error.speed_mps = random.normal(0.0, kSpeedWhite_mps);
    error.yaw_rate_radps = bias + random.normal(0.0, kYawRateWhite_radps);
    // Each wheel has its own noise; the mean of both has kSpeedWhite_mps.
    error.wheels_mps = wheels.normal(0.0, 2.0 * kSpeedWhite_mps);
    bias += random.normal(0.0, kYawRateBiasWalk * std::sqrt(kPeriod_s));
  }
}

OdometryReading OdometrySimulator::reading(size_t index) const {
  assert(index < errors_.size());
  const double time_s = static_cast<double>(index) * kPeriod_s;
  const Drive::State truth = drive_.at(time_s);
  const Error& error = errors_[index];
  return {.time_s = time_s,
          .speed_mps = speed_scale_ * truth.speed_mps + error.speed_mps,
          .yaw_rate_radps = truth.yaw_rate_radps + error.yaw_rate_radps,
          .path_yaw_rate_radps = truth.yaw_rate_radps,
          .wheel_excess_mps = radius_difference_ * truth.speed_mps + error.wheels_mps};
}

}  // namespace bevloc::sim
