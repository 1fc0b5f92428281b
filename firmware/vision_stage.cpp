#include "firmware/vision_stage.h"

#include <algorithm>

namespace bevloc::firmware {

VisionStage::VisionStage(Localizer& localizer, const drivers::SynchronizerConfig& synchronizer,
                         FrameQueue& frames, PredictionQueue& predictions, VisionQueue& reports)
    : localizer_(localizer),
      synchronizer_(synchronizer),
      frames_(frames),
      predictions_(predictions),
      reports_(reports) {}

void VisionStage::observe(std::function<void(const VisionSnapshot&)> observer) {
  observer_ = std::move(observer);
}

bool VisionStage::step(const drivers::Clock& clock, Duration timeout) {
  ++counters_.steps;
  take_in(clock, timeout);
  const uint64_t skipped_before = counters_.framesets_skipped;
  const auto frameset = newest_frameset(clock.now());
  if (!frameset) return false;
  localize(*frameset, counters_.framesets_skipped > skipped_before);
  return true;
}

void VisionStage::take_in(const drivers::Clock& clock, Duration timeout) {
  // A set that waits for a dead camera must go out on time although no frame arrives.
  if (const auto deadline = synchronizer_.deadline()) {
    timeout = std::clamp(*deadline - clock.now(), Duration::zero(), timeout);
  }
  for (auto frame = frames_.pop(timeout); frame; frame = frames_.pop(Duration::zero())) {
    synchronizer_.add(std::move(*frame), clock.now());
  }
  while (auto prediction = predictions_.pop(Duration::zero())) {
    trail_.add(prediction->pose);
    acquiring_ = prediction->acquiring;
  }
}

std::optional<drivers::Frameset> VisionStage::newest_frameset(Time now) {
  auto newest = synchronizer_.poll(now);
  if (!newest) return std::nullopt;
  while (auto newer = synchronizer_.poll(now)) {
    ++counters_.framesets_skipped;
    counters_.frames_skipped += newest->present.count();
    newest = std::move(newer);
  }
  return newest;
}

void VisionStage::localize(const drivers::Frameset& frameset, bool skipped) {
  VisionReport report;
  report.frame_time = frameset.time;
  report.present = frameset.present;
  report.skipped = skipped;
  ++counters_.framesets;
  counters_.frames_used += frameset.present.count();

  const auto prior = trail_.at(frameset.time);
  report.had_prior = prior.has_value();
  if (!prior) {
    ++counters_.no_prior;
    reports_.push(report);
    return;
  }
  report.prior = *prior;
  std::array<RgbView, kCameraCount> images;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (frameset.present[camera]) images[camera] = frameset.frames[camera].pixels();
  }
  const SearchRange range = acquiring_ ? SearchRange::kAcquiring : SearchRange::kTracking;
  if (localizer_.localize(images, frameset.present, *prior, range, solution_)) {
    report.map_nearby = localizer_.map_nearby();
    report.correction = solution_;
    if (observer_) observer_({frameset, report, solution_, range, localizer_});
  } else {
    ++counters_.refused;
  }
  reports_.push(report);
}

}  // namespace bevloc::firmware
