#include "firmware/vision_stage.h"

#include <algorithm>
#include <cmath>

namespace bevloc::firmware {
namespace {

/// Faster than this, and no two pictures of a camera are the same. What odometry says of a vehicle
/// that stands is far below.
constexpr double kDriving_mps = 1.0;

}  // namespace

VisionStage::VisionStage(Localizer& localizer, const VisionConfig& config, FrameQueue& frames,
                         PredictionQueue& predictions, VisionQueue& reports)
    : localizer_(localizer),
      min_cameras_(config.synchronizer.min_cameras),
      compensate_motion_(config.compensate_motion),
      synchronizer_(config.synchronizer),
      synchrony_(synchronizer_, config.compensate_motion, config.pulses),
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
  const Time now = clock.now();
  const auto frameset = newest_frameset(now);
  if (frameset) {
    localize(*frameset, report_on(*frameset, now, counters_.framesets_skipped > skipped_before));
  } else if (synchrony_.split_without_sets(now)) {
    VisionReport report;
    report.frame_time = now;
    report.unsynchronized = true;
    reports_.push(report);
  }
  return frameset.has_value();
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

VisionReport VisionStage::report_on(const drivers::Frameset& frameset, Time now, bool skipped) {
  VisionReport report;
  report.frame_time = frameset.time;
  report.present = frameset.present;
  report.skipped = skipped;
  report.unsynchronized = synchrony_.unsynchronized(frameset, now);
  return report;
}

void VisionStage::localize(const drivers::Frameset& frameset, VisionReport report) {
  ++counters_.framesets;
  counters_.frames_used += frameset.present.count();

  const auto prior = trail_.at(frameset.time);
  const auto motions = motions_in(frameset);
  report.had_prior = prior && motions;
  if (report.had_prior) {
    report.prior = *prior;
    match(frameset, *motions, report);
  } else {
    ++counters_.no_prior;
  }
  reports_.push(report);
}

void VisionStage::match(const drivers::Frameset& frameset, const CameraMotions& motions,
                        VisionReport& report) {
  const double speed_mps = trail_.speed_mps(frameset.time).value_or(0.0);
  CameraImages seen{{}, frameset.present, motions, std::abs(speed_mps) > kDriving_mps};
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (frameset.present[camera]) seen.images[camera] = frameset.frames[camera].image();
  }
  const SearchRange range = acquiring_ ? SearchRange::kAcquiring : SearchRange::kTracking;
  report.present = localizer_.localize(seen, report.prior, range, solution_);
  report.map_nearby = localizer_.map_nearby();
  count_left_out(frameset.present, report.present);
  if (static_cast<int>(report.present.count()) < min_cameras_) {
    ++counters_.refused;
    return;
  }
  report.correction = solution_;
  if (observer_) observer_({frameset, report, solution_, range, localizer_});
}

void VisionStage::count_left_out(CameraMask given, CameraMask used) {
  const CameraMask unreadable = given & ~used & ~localizer_.frozen();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (unreadable[camera]) ++counters_.unreadable[camera];
  }
  counters_.frozen = static_cast<unsigned>(localizer_.frozen().to_ulong());
}

std::optional<CameraMotions> VisionStage::motions_in(const drivers::Frameset& frameset) const {
  CameraMotions reference_from_exposure{};
  if (!compensate_motion_) return reference_from_exposure;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (!frameset.present[camera]) continue;
    const auto motion = trail_.motion(frameset.time, frameset.frames[camera].time);
    if (!motion) return std::nullopt;
    reference_from_exposure[camera] = *motion;
  }
  return reference_from_exposure;
}

}  // namespace bevloc::firmware
