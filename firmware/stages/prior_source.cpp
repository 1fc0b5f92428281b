#include "firmware/stages/prior_source.h"

namespace bevloc::firmware {

void PriorSource::take_predictions() {
  while (const auto prediction = predictions_.pop(Duration::zero())) {
    trail_.add(prediction->pose);
    acquiring_ = prediction->acquiring;
  }
}

std::optional<Prior> PriorSource::at(const drivers::Frameset& frameset) const {
  const auto pose = trail_.at(frameset.time);
  const auto motions = motions_in(frameset);
  if (!pose || !motions) return std::nullopt;
  return Prior{*pose, *motions, trail_.speed_mps(frameset.time).value_or(0.0),
               acquiring_ ? SearchRange::kAcquiring : SearchRange::kTracking};
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
