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

    double speed_mps() const { return 0.5 * (left_mps + right_mps); }
  };

  /// `rear_track_m` is the distance between the rear wheels.
  explicit OdometryCheck(double rear_track_m) : rear_track_m_(rear_track_m) {}

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

  double rear_track_m_;
  /// Compares the mean of some samples with what was learned from the samples before.
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
