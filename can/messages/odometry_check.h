// Checks whether wheel speeds and yaw rate can be those of a road vehicle.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "can/messages/wheel_difference.h"
#include "common/time.h"

namespace bevloc::can {

enum class OdometryVerdict : uint8_t {
  kPlausible,
  kWheelsContradictYawRate,
  kSpeedJump,
  kYawRateJump,
  kTooSharp,  ///< no vehicle turns so fast at this speed
};
inline constexpr size_t kOdometryVerdicts = 5;

/// Judges the samples in the order of their time by what a road vehicle can do, with a margin for
/// noise. The limits are wide, because they refuse only what no vehicle does. The tracker weighs
/// everything else. One thread.
class OdometryCheck {
 public:
  struct Wheels {
    Time time{};
    double left_mps = 0.0;
    double right_mps = 0.0;
    double yaw_rate_radps = 0.0;
    /// Whether each side was measured. Otherwise the wheels cannot contradict the yaw rate.
    bool both_sides = true;

    double speed_mps() const { return 0.5 * (left_mps + right_mps); }
  };

  /// `rear_track_m` is the distance between the rear wheels. Samples come every `interval`.
  OdometryCheck(double rear_track_m, Duration interval)
      : rear_track_m_(rear_track_m), interval_s_(to_seconds(interval)) {}

  OdometryVerdict judge(const Wheels& sample);

  /// Call it after a time that the clock did not count. The vehicle may have any speed then, so the
  /// next sample is not compared with earlier ones. What was learned about the wheels stays.
  void note_gap();

  /// Whether the samples come much less often than they should. This becomes true when their mean
  /// interval exceeds the right one by a factor of 2.25, and false when it is below 1.5 times that
  /// interval: 45 ms and 30 ms for samples that should come every 20 ms.
  bool is_slow() const { return slow_; }

  /// OdometrySample::wheel_lean of the latest sample.
  const std::optional<double>& wheel_lean() const { return wheel_lean_; }

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

  double rear_track_m_;
  double interval_s_;
  /// Compares the mean of some samples with what was learned from the samples before.
  WheelDifference learned_difference_;
  std::optional<double> wheel_lean_;
  static constexpr size_t kRecent = 10;
  /// Plausible samples, oldest first. The last one is the latest.
  std::array<Wheels, kRecent> recent_{};
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
