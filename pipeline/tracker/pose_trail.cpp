#include "pipeline/tracker/pose_trail.h"

#include <cmath>

namespace bevloc {
namespace {

/// Position of `time` between two poses: 0 at `before`, 1 at `after`.
double share_of(Time time, const TrackedPose& before, const TrackedPose& after) {
  return to_seconds(time - before.time) / to_seconds(after.time - before.time);
}

Se2 interpolate(const TrackedPose& before, const TrackedPose& after, Time time) {
  const double share = share_of(time, before, after);
  const Se2 step = correction_between(before.map_from_vehicle, after.map_from_vehicle);
  return before.map_from_vehicle * Se2{share * step.x_m, share * step.y_m, share * step.yaw_rad};
}

}  // namespace

void PoseTrail::add(const TrackedPose& pose) {
  while (!poses_.empty() && poses_.back().time >= pose.time) poses_.pop_back();
  if (!poses_.empty() && pose.time - poses_.back().time > kGap) poses_.clear();
  poses_.push_back(pose);
}

std::optional<Se2> PoseTrail::at(Time time) const {
  const auto [before, after] = neighbours(time);
  if (!before) return std::nullopt;
  if (after) return interpolate(*before, *after, time);
  return before->map_from_vehicle *
         arc_motion(before->speed_mps, before->yaw_rate_radps, to_seconds(time - before->time));
}

std::optional<double> PoseTrail::speed_mps(Time time) const {
  const auto rates = rates_at(time);
  return rates ? std::optional(rates->speed_mps) : std::nullopt;
}

std::optional<Se2> PoseTrail::motion(Time from, Time to) const {
  const auto rates = rates_at(from + (to - from) / 2);
  if (!rates) return std::nullopt;
  return arc_motion(rates->speed_mps, rates->yaw_rate_radps, to_seconds(to - from));
}

std::optional<PoseTrail::Rates> PoseTrail::rates_at(Time time) const {
  const auto [before, after] = neighbours(time);
  if (!before) return std::nullopt;
  if (!after) return Rates{before->speed_mps, before->yaw_rate_radps};
  const double share = share_of(time, *before, *after);
  return Rates{std::lerp(before->speed_mps, after->speed_mps, share),
               std::lerp(before->yaw_rate_radps, after->yaw_rate_radps, share)};
}

PoseTrail::Neighbours PoseTrail::neighbours(Time time) const {
  if (poses_.empty()) return {};
  const TrackedPose& newest = poses_.back();
  if (time >= newest.time) {
    if (time - newest.time > kReach) return {};
    return {&newest, nullptr};
  }
  for (size_t after = poses_.size() - 1; after > 0; --after) {
    if (poses_[after - 1].time <= time) return {&poses_[after - 1], &poses_[after]};
  }
  return {};
}

}  // namespace bevloc
