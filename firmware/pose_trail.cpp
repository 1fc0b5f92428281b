#include "firmware/pose_trail.h"

namespace bevloc::firmware {
namespace {

/// Drives on for a while at constant speed and yaw rate; exact enough over a tenth of a second.
Se2 drive_on(const TrackedPose& from, Duration duration) {
  const double dt_s = to_seconds(duration);
  const double turn_rad = from.yaw_rate_radps * dt_s;
  const double way_m = from.speed_mps * dt_s;
  const Se2 step{way_m * std::cos(0.5 * turn_rad), way_m * std::sin(0.5 * turn_rad), turn_rad};
  return from.map_from_vehicle * step;
}

Se2 interpolate(const TrackedPose& before, const TrackedPose& after, Time time) {
  const double share = to_seconds(time - before.time) / to_seconds(after.time - before.time);
  const Se2 step = correction_between(before.map_from_vehicle, after.map_from_vehicle);
  return before.map_from_vehicle * Se2{share * step.x_m, share * step.y_m, share * step.yaw_rad};
}

}  // namespace

void PoseTrail::add(const TrackedPose& pose) {
  while (size_ > 0 && nth_newest(0).time >= pose.time) {
    next_ = (next_ + kCapacity - 1) % kCapacity;
    --size_;
  }
  poses_[next_] = pose;
  next_ = (next_ + 1) % kCapacity;
  size_ = size_ < kCapacity ? size_ + 1 : kCapacity;
}

std::optional<Se2> PoseTrail::at(Time time) const {
  if (size_ == 0) return std::nullopt;
  const TrackedPose& newest = nth_newest(0);
  if (time >= newest.time) {
    if (time - newest.time > kReach) return std::nullopt;
    return drive_on(newest, time - newest.time);
  }
  for (int n = 1; n < size_; ++n) {
    if (nth_newest(n).time <= time) return interpolate(nth_newest(n), nth_newest(n - 1), time);
  }
  return std::nullopt;
}

}  // namespace bevloc::firmware
