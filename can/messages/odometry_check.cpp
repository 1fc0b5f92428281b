#include "can/messages/odometry_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace bevloc::can {
namespace {

// The difference of the wheel speeds may deviate from yaw rate times track by the sum of three
// parts: this speed, this share of the vehicle's speed (tyres of different wear differ by up to 3 %
// in radius), and this length times the yaw rate (error of the track, slip in bends).
constexpr double kWheelDifference_mps = 0.8;
constexpr double kWheelDifferenceShare = 0.03;
constexpr double kWheelDifference_m = 0.3;

// Along the vehicle, tyres hold about 1.2 g when braking, and no series car gains speed with more
// than 1 g. The step allows for noise and a late time stamp. Each sample is compared with those of
// the last 100 ms, because spinning wheels gain their speed within several samples. If samples come
// faster than every 12.5 ms, only some of them are kept, so that those cover the 100 ms.
constexpr double kBraking_mps2 = 12.0;
constexpr double kGaining_mps2 = 10.0;
constexpr double kSpeedStep_mps = 0.3;
constexpr double kYawAcceleration_radps2 = 5.0;
constexpr double kYawRateStep_radps = 0.05;
constexpr Duration kComparedWith = std::chrono::milliseconds(100);
constexpr Duration kKeptApart = kComparedWith / 8;

// Across the vehicle, tyres hold about 1.2 g. The turning radius of the rear axle of a small car is
// about 3 m.
constexpr double kLateralAcceleration_mps2 = 12.0;
constexpr double kTurningRadius_m = 2.0;
constexpr double kYawRateAtStandstill_radps = 0.2;

// After a jump, only values near the one before the jump are used, because spinning or locked
// wheels end with a second jump back. A level that has lasted for kSettledAfter is used again,
// because traction control and anti-lock brakes end a slip sooner.
constexpr double kDisputedAcceleration_mps2 = 0.5;
constexpr Duration kSettledAfter = std::chrono::milliseconds(2500);

// Limits of the mean interval, as multiples of the interval at which samples should come.
constexpr double kSlowFactor = 2.25;
constexpr double kTimelyFactor = 1.5;
/// A longer interval counts as this multiple, so that a single gap, however long, does not count as
/// slow odometry.
constexpr double kLongestFactor = 10.0;
/// The mean follows the interval within about ten samples.
constexpr double kIntervalGain = 0.1;

}  // namespace

OdometryVerdict OdometryCheck::judge(const Wheels& sample) {
  watch_rate(sample.time);
  const OdometryVerdict verdict = verdict_of(sample);
  ++counts_[static_cast<size_t>(verdict)];
  return verdict;
}

void OdometryCheck::note_gap() {
  recent_count_ = 0;
  disputed_.reset();
}

OdometryVerdict OdometryCheck::verdict_of(const Wheels& sample) {
  if (is_too_sharp(sample)) return OdometryVerdict::kTooSharp;
  if (wheels_contradict(sample)) return OdometryVerdict::kWheelsContradictYawRate;
  if (disputed_) {
    const bool same_level = jump(*disputed_, sample) == OdometryVerdict::kPlausible;
    if (!same_level) disputed_level_since_ = sample.time;
    disputed_ = sample;
    const bool settled = sample.time - disputed_level_since_ >= kSettledAfter;
    if (!is_back(sample) && !settled) {
      const OdometryVerdict verdict = jump(before_jump_, sample);
      return verdict == OdometryVerdict::kPlausible ? OdometryVerdict::kSpeedJump : verdict;
    }
    disputed_.reset();
    recent_count_ = 0;
  } else if (const auto verdict = jump_from_recent(sample);
             verdict != OdometryVerdict::kPlausible) {
    disputed_ = sample;
    disputed_level_since_ = sample.time;
    return verdict;
  }
  keep(sample);
  return OdometryVerdict::kPlausible;
}

OdometryVerdict OdometryCheck::jump_from_recent(const Wheels& sample) {
  for (size_t i = 0; i < recent_count_; ++i) {
    const OdometryVerdict verdict = jump(recent_[i], sample);
    if (verdict == OdometryVerdict::kPlausible) continue;
    before_jump_ = recent_[0];
    return verdict;
  }
  return OdometryVerdict::kPlausible;
}

bool OdometryCheck::is_back(const Wheels& sample) const {
  const double elapsed_s = to_seconds(sample.time - before_jump_.time);
  const double allowed_mps = kSpeedStep_mps + kDisputedAcceleration_mps2 * elapsed_s;
  return std::abs(sample.speed_mps() - before_jump_.speed_mps()) <= allowed_mps &&
         !yaw_rate_jumps(before_jump_, sample);
}

/// Keeps samples of the compared time, and at least the latest one.
void OdometryCheck::keep(const Wheels& sample) {
  const bool near_the_one_before =
      recent_count_ >= 2 &&
      recent_[recent_count_ - 1].time - recent_[recent_count_ - 2].time < kKeptApart;
  if (near_the_one_before) --recent_count_;
  const auto end = recent_.begin() + static_cast<std::ptrdiff_t>(recent_count_);
  auto first = std::find_if(recent_.begin(), end, [&](const Wheels& kept) {
    return sample.time - kept.time <= kComparedWith;
  });
  if (first == recent_.begin() && recent_count_ == kRecent) ++first;
  recent_count_ = static_cast<size_t>(std::move(first, end, recent_.begin()) - recent_.begin());
  recent_[recent_count_++] = sample;
}

bool OdometryCheck::is_too_sharp(const Wheels& sample) const {
  const double speed_mps = std::abs(sample.speed_mps());
  const double yaw_rate_radps = std::abs(sample.yaw_rate_radps);
  return speed_mps * yaw_rate_radps > kLateralAcceleration_mps2 ||
         yaw_rate_radps > kYawRateAtStandstill_radps + speed_mps / kTurningRadius_m;
}

bool OdometryCheck::wheels_contradict(const Wheels& sample) {
  wheel_lean_.reset();
  const double expected_mps = sample.yaw_rate_radps * rear_track_m_;
  const double excess_mps = sample.right_mps - sample.left_mps - expected_mps;
  const double allowed_mps = kWheelDifference_mps +
                             kWheelDifferenceShare * std::abs(sample.speed_mps()) +
                             kWheelDifference_m * std::abs(sample.yaw_rate_radps);
  if (std::abs(excess_mps) > allowed_mps) return true;
  if (!sample.both_sides) return false;
  const bool contradict = learned_difference_.contradicts(
      {sample.time, excess_mps, sample.speed_mps(), sample.yaw_rate_radps});
  wheel_lean_ = learned_difference_.lean();
  return contradict;
}

bool OdometryCheck::speed_jumps(const Wheels& from, const Wheels& to) const {
  const double elapsed_s = std::max(0.0, to_seconds(to.time - from.time));
  const bool gains = std::abs(to.speed_mps()) > std::abs(from.speed_mps());
  const double acceleration_mps2 = gains ? kGaining_mps2 : kBraking_mps2;
  return std::abs(to.speed_mps() - from.speed_mps()) >
         kSpeedStep_mps + acceleration_mps2 * elapsed_s;
}

bool OdometryCheck::yaw_rate_jumps(const Wheels& from, const Wheels& to) const {
  const double elapsed_s = std::max(0.0, to_seconds(to.time - from.time));
  return std::abs(to.yaw_rate_radps - from.yaw_rate_radps) >
         kYawRateStep_radps + kYawAcceleration_radps2 * elapsed_s;
}

OdometryVerdict OdometryCheck::jump(const Wheels& from, const Wheels& to) const {
  if (speed_jumps(from, to)) return OdometryVerdict::kSpeedJump;
  return yaw_rate_jumps(from, to) ? OdometryVerdict::kYawRateJump : OdometryVerdict::kPlausible;
}

void OdometryCheck::watch_rate(Time time) {
  if (!latest_) mean_interval_s_ = interval_s_;
  if (latest_) {
    const double longest_s = kLongestFactor * interval_s_;
    const double interval_s = std::min(to_seconds(time - *latest_), longest_s);
    mean_interval_s_ += kIntervalGain * (interval_s - mean_interval_s_);
  }
  latest_ = time;
  if (mean_interval_s_ > kSlowFactor * interval_s_) slow_ = true;
  if (mean_interval_s_ < kTimelyFactor * interval_s_) slow_ = false;
}

}  // namespace bevloc::can
