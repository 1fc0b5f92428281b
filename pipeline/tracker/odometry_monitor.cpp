#include "pipeline/tracker/odometry_monitor.h"

#include <cmath>

#include "common/se2.h"

namespace bevloc {
namespace {

/// If the steps of speed and yaw rate are fine, their noise changes the last digits from sample to
/// sample. If both then repeat exactly so many times while driving, they are no longer measured.
constexpr int kStuckRepetitions = 12;
constexpr double kDriving_mps = 0.5;

/// More than tyres can transmit: emergency braking reaches 11 m/s^2. A slipping or locked wheel
/// changes its speed faster.
constexpr double kMaxAcceleration_mps2 = 13.0;
constexpr double kSpeedNoise_mps = 0.6;
/// A vehicle stands for a moment before it changes its direction. Two samples that are more than
/// kGap_s apart may miss this standstill.
constexpr double kStandstill_mps = 1.0;
constexpr double kGap_s = 0.5;
constexpr double kMaxYawAcceleration_radps2 = radians(150.0);
constexpr double kYawRateNoise_radps = radians(2.0);

}  // namespace

bool OdometryMonitor::accept(const OdometrySample& sample) {
  implausible_ = is_stuck(sample) || jumps(sample) || turns_round(sample);
  latest_ = sample;
  if (!implausible_) accepted_ = sample;
  return !implausible_;
}

bool OdometryMonitor::is_stuck(const OdometrySample& sample) {
  const bool repeats = sample.has_fine_steps && latest_ && latest_->speed_mps == sample.speed_mps &&
                       latest_->yaw_rate_radps == sample.yaw_rate_radps &&
                       std::abs(sample.speed_mps) > kDriving_mps;
  repetitions_ = repeats ? repetitions_ + 1 : 0;
  return repetitions_ >= kStuckRepetitions;
}

/// Whether the speed has changed its sign without a standstill in between. A lasting jump is
/// accepted after a while, but such a change is not, as long as there is no gap between samples.
bool OdometryMonitor::turns_round(const OdometrySample& sample) const {
  if (!accepted_ || !latest_ || to_seconds(sample.time - latest_->time) > kGap_s) return false;
  return std::abs(sample.speed_mps) > kStandstill_mps &&
         std::abs(accepted_->speed_mps) > kStandstill_mps &&
         std::signbit(sample.speed_mps) != std::signbit(accepted_->speed_mps);
}

/// The permitted change grows with time since the last accepted sample, so a lasting change is
/// accepted in the end.
bool OdometryMonitor::jumps(const OdometrySample& sample) const {
  if (!accepted_) return false;
  const double interval_s = to_seconds(sample.time - accepted_->time);
  return std::abs(sample.speed_mps - accepted_->speed_mps) >
             kMaxAcceleration_mps2 * interval_s + kSpeedNoise_mps ||
         std::abs(sample.yaw_rate_radps - accepted_->yaw_rate_radps) >
             kMaxYawAcceleration_radps2 * interval_s + kYawRateNoise_radps;
}

}  // namespace bevloc
