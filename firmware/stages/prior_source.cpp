#include "firmware/stages/prior_source.h"

#include <utility>

namespace bevloc::firmware {

void PriorSource::take_predictions() {
  while (const auto prediction = predictions_.pop(Duration::zero())) {
    trail_.add(prediction->pose);
    acquiring_ = prediction->acquiring;
  }
}

std::optional<Prior> PriorSource::at(const drivers::Frameset& frameset) {
  const auto driven = step_until(frameset.time);
  const auto pose = trail_.at(frameset.time);
  const auto motions = motions_in(frameset);
  if (!pose || !motions) return std::nullopt;
  return Prior{*pose, *motions, trail_.speed_mps(frameset.time).value_or(0.0),
               acquiring_ ? SearchRange::kAcquiring : SearchRange::kTracking, driven};
}

std::optional<DrivenStep> PriorSource::step_until(Time time) {
  // PoseTrail uses the rates at the middle time, which suffices for two neighbouring framesets.
  constexpr Duration kFarthest = std::chrono::milliseconds(150);
  const std::optional<Time> from = std::exchange(previous_time_, time);
  if (!from || time < *from || time - *from > kFarthest) return std::nullopt;
  const auto motion = trail_.motion(*from, time);
  if (!motion) return std::nullopt;
  return DrivenStep{*from, time, *motion};
}

std::optional<CameraMotions> PriorSource::motions_in(const drivers::Frameset& frameset) const {
  CameraMotions reference_from_exposure{};
  if (!compensates_) return reference_from_exposure;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (!frameset.present[camera]) continue;
    const auto motion = trail_.motion(frameset.time, frameset.frames[camera].time);
    if (!motion) return std::nullopt;
    reference_from_exposure[camera] = *motion;
  }
  return reference_from_exposure;
}

}  // namespace bevloc::firmware
