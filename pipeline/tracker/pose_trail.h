// Keeps the recent pose predictions, to look up the pose at the time of an exposure.
#pragma once

#include <optional>

#include <boost/circular_buffer.hpp>

#include "pipeline/tracker/tracker.h"

namespace bevloc {

/// The latest 128 predictions of the tracker. The vision stage keeps its own trail, so that it can
/// look up T0 without asking the thread of the tracker. Allocates in the constructor only. One
/// thread.
class PoseTrail {
 public:
  /// How far past the newest pose the trail extrapolates.
  static constexpr Duration kReach = std::chrono::milliseconds(150);

  /// Poses further apart do not belong to one motion: the machine was suspended, or poses are
  /// missing. Predictions come every 10 ms.
  static constexpr Duration kGap = std::chrono::milliseconds(500);

  /// Removes the poses at or after `pose.time`, and all poses if the newest is more than kGap older
  /// than `pose`. Then appends `pose`.
  void add(const TrackedPose& pose);

  /// Returns map_from_vehicle at `time`: interpolated between two poses, or extrapolated past the
  /// newest pose with its speed and yaw rate. Returns nothing before the oldest pose or more than
  /// kReach past the newest one.
  std::optional<Se2> at(Time time) const;

  /// Speed along the vehicle at `time`, in the same range as at().
  std::optional<double> speed_mps(Time time) const;

  /// The vehicle's motion: its pose at `to` in the vehicle frame at `from`. The two times should
  /// lie at most 0.1 s apart and may come in either order. It is computed from speed and yaw rate
  /// at the middle time rather than from the poses, because corrections make the poses jump.
  std::optional<Se2> motion(Time from, Time to) const;

 private:
  static constexpr size_t kCapacity = 128;

  struct Rates {
    double speed_mps = 0.0;
    double yaw_rate_radps = 0.0;
  };
  std::optional<Rates> rates_at(Time time) const;

  /// Both are null outside the trail; `after` is null past the newest pose.
  struct Neighbours {
    const TrackedPose* before = nullptr;
    const TrackedPose* after = nullptr;
  };
  Neighbours neighbours(Time time) const;

  boost::circular_buffer<TrackedPose> poses_{kCapacity};  ///< sorted by time
};

}  // namespace bevloc
