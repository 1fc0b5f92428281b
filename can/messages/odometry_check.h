// Checks whether wheel speeds and yaw rate can be those of a road vehicle.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "can/messages/wheel_difference.h"
#include "common/time.h"

namespace bevloc::can {

/// What a road vehicle can do, with a margin for noise. The limits are wide, because they refuse
/// only what no vehicle does. The tracker weighs everything else.
struct OdometryLimits {
  double rear_track_m = 1.6;  ///< distance between the rear wheels

  /// The difference of the wheel speeds may deviate from yaw rate times track by the sum of three
  /// parts: this speed, this share of the vehicle's speed (tyres of different wear differ by up to
  /// 3 % in radius), and this length times the yaw rate (error of the track, slip in bends).
  double wheel_difference_mps = 0.8;
  double wheel_difference_share = 0.03;
  double wheel_difference_m = 0.3;
  /// The mean of some samples is compared with what was learned from the samples before.
  WheelDifferenceLimits learned_wheel_difference;

  /// Along the vehicle, tyres hold about 1.2 g when braking, and no series car gains speed with
  /// more than 1 g. The step allows for noise and a late time stamp. Each sample is compared with
  /// those of the last 100 ms, at most eight, because spinning wheels gain their speed within
  /// several samples.
  double braking_mps2 = 12.0;
  double gaining_mps2 = 10.0;
  double speed_step_mps = 0.3;
  double yaw_acceleration_radps2 = 5.0;
  double yaw_rate_step_radps = 0.05;
  Duration compared_with = std::chrono::milliseconds(100);

  /// Across the vehicle, tyres hold about 1.2 g. The turning radius of the rear axle of a small car
  /// is about 3 m.
  double lateral_acceleration_mps2 = 12.0;
  double turning_radius_m = 2.0;
  double yaw_rate_at_standstill_radps = 0.2;

  /// After a jump, only values near the one before the jump are used, because spinning or locked
  /// wheels end with a second jump back. A level that has lasted for `settled_after` is used again,
  /// because spin and lock control end a slip sooner.
  double disputed_acceleration_mps2 = 0.5;
  Duration settled_after = std::chrono::milliseconds(2500);
};

enum class OdometryVerdict : uint8_t {
  kPlausible,
  kWheelsContradictYawRate,
  kSpeedJump,
  kYawRateJump,
  kTooSharp,  ///< no vehicle turns so fast at this speed
};
inline constexpr size_t kOdometryVerdicts = 5;

/// Judges the samples in the order of their time. One thread.
class OdometryCheck {
 public:
  struct Wheels {
    Time time{};
    double left_mps = 0.0;
    double right_mps = 0.0;
    double yaw_rate_radps = 0.0;

    double speed_mps() const { return 0.5 * (left_mps + right_mps); }
  };

  explicit OdometryCheck(const OdometryLimits& limits)
      : limits_(limits), learned_difference_(limits.learned_wheel_difference) {}

  OdometryVerdict judge(const Wheels& sample);

  /// Whether the samples come much less often than every `kOdometryCycleMs`. This becomes true when
  /// their mean interval exceeds 45 ms, and false when it is below 30 ms.
  bool is_slow() const { return slow_; }

  /// OdometrySample::wheel_lean of the latest sample.
  std::optional<double> wheel_lean() const { return learned_difference_.lean(); }

  /// Number of samples with this verdict.
  uint64_t count(OdometryVerdict verdict) const { return counts_[static_cast<size_t>(verdict)]; }

 private:
  OdometryVerdict verdict_of(const Wheels& sample);
  bool is_too_sharp(const Wheels& sample) const;
  bool speed_jumps(const Wheels& from, const Wheels& to) const;
  bool yaw_rate_jumps(const Wheels& from, const Wheels& to) const;
  OdometryVerdict jump(const Wheels& from, const Wheels& to) const;
  OdometryVerdict jump_from_recent(const Wheels& sample);
  bool is_back(const Wheels& sample) const;
  bool wheels_contradict(const Wheels& sample);
  void keep(const Wheels& sample);
  void watch_rate(Time time);

  OdometryLimits limits_;
  WheelDifference learned_difference_;
  static constexpr size_t kRecent = 8;
  std::array<Wheels, kRecent> recent_{};  ///< plausible samples, oldest first
  size_t recent_count_ = 0;
  Wheels before_jump_{};
  std::optional<Wheels> disputed_;  ///< the latest sample since a jump
  Time disputed_level_since_{};
  std::optional<Time> latest_;
  double mean_interval_s_ = 0.0;
  bool slow_ = false;
  std::array<uint64_t, kOdometryVerdicts> counts_{};
};

}  // namespace bevloc::can
