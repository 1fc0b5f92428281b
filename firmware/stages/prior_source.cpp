#include "firmware/stages/prior_source.h"

#include <algorithm>
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
  // PoseTrail uses the rates at the middle time, which suffices for a part of this length.
  constexpr Duration kLongestPart = std::chrono::milliseconds(150);
  constexpr Duration kFarthest = 3 * kLongestPart;
  const std::optional<Time> from = std::exchange(previous_time_, time);
  if (!from || time < *from || time - *from > kFarthest) return std::nullopt;
  const Duration whole = time - *from;
  const auto parts =
      std::max<Duration::rep>((whole + kLongestPart - Duration(1)) / kLongestPart, 1);
  DrivenStep step{*from, time, {}};
  for (Duration::rep part = 0; part < parts; ++part) {
    const auto motion =
        trail_.motion(*from + whole * part / parts, *from + whole * (part + 1) / parts);
    if (!motion) return std::nullopt;
    step.motion = step.motion * *motion;
  }
  return step;
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
