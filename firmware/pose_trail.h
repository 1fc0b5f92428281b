// The poses that the estimator predicted lately, for whoever needs one at an earlier time.
#pragma once

#include <array>
#include <optional>

#include "pipeline/tracker/tracker.h"

namespace bevloc::firmware {

/// A ring of the newest predictions. The vision stage keeps one so that it finds T0 at the time of
/// exposure without asking the estimator's thread. Not thread safe; never allocates.
class PoseTrail {
 public:
  /// At most this far beyond the newest pose is anything still known.
  static constexpr Duration kReach = std::chrono::milliseconds(150);

  /// A pose that is not newer than the latest one replaces it and all that came after it.
  void add(const TrackedPose& pose);

  /// Between two poses by interpolation, past the newest by its speed and yaw rate; nothing
  /// outside.
  std::optional<Se2> at(Time time) const;

  /// Along the vehicle, likewise.
  std::optional<double> speed_mps(Time time) const;

  /// How the vehicle moved: its pose at `to`, seen from that at `from`. From speed and yaw rate at
  /// the middle of the two times, which are meant to lie a tenth of a second apart at most. The
  /// poses themselves do not count: a correction makes them jump, the vehicle does not.
  std::optional<Se2> motion(Time from, Time to) const;

 private:
  static constexpr int kCapacity = 128;

  struct Rates {
    double speed_mps = 0.0;
    double yaw_rate_radps = 0.0;
  };
  std::optional<Rates> rates_at(Time time) const;

  /// Both null where nothing is known; `after` null past the newest pose.
  struct Neighbours {
    const TrackedPose* before = nullptr;
    const TrackedPose* after = nullptr;
  };
  Neighbours neighbours(Time time) const;

  const TrackedPose& nth_newest(int n) const {
    return poses_[(next_ + kCapacity - 1 - n) % kCapacity];
  }

  std::array<TrackedPose, kCapacity> poses_{};
  int next_ = 0;
  int size_ = 0;
};

}  // namespace bevloc::firmware
