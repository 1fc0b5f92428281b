#include "firmware/stages/vision_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <spdlog/spdlog.h>

#include "pipeline/tracker/motion_model.h"

namespace bevloc::firmware {
namespace {

/// Above this speed no two images of a camera are the same. The odometry of a standing vehicle
/// stays far below it.
constexpr double kDriving_mps = 1.0;

/// The network is checked when the vehicle has stood for the first of these times, and not more
/// often than the second one.
constexpr Duration kSettledStanding = std::chrono::seconds(1);
constexpr Duration kCheckPeriod = std::chrono::seconds(60);

/// Displaced frames are reported again after this time.
constexpr Duration kDisplacedPeriod = std::chrono::milliseconds(200);

CameraMask with_jumped_stamps(const drivers::Frameset& frameset) {
  CameraMask jumped;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    jumped[camera] = frameset.present[camera] && frameset.frames[camera].stamp_jumped;
  }
  return jumped;
}

/// The lower median over the cameras: more than half of them have jumped at least as often.
uint64_t stamp_jumps_of_most(const drivers::Frameset& frameset) {
  std::array<uint64_t, kCameraCount> jumps{};
  auto end = jumps.begin();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (frameset.present[camera]) *end++ = frameset.frames[camera].stamp_jumps;
  }
  if (end == jumps.begin()) return 0;
  const auto median = jumps.begin() + (end - jumps.begin() - 1) / 2;
  std::nth_element(jumps.begin(), median, end);
  return *median;
}

/// The part of an error that is the same for every image with the same cause. The numbers, and what
/// libjpeg says in parentheses, may differ from image to image.
std::string_view cause_of(std::string_view error) {
  return error.substr(0, error.find_first_of("(0123456789"));
}

/// Leaves out some frames. Frameset::time becomes that of the earliest frame that remains, and
/// stays as it is if none remains.
void leave_out(CameraMask cameras, drivers::Frameset& frameset) {
  frameset.present &= ~cameras;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (cameras[camera]) frameset.frames[camera] = {};
  }
  if (cameras.none() || frameset.present.none()) return;
  Time earliest = Time::max();
  Time latest = Time::min();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (!frameset.present[camera]) continue;
    earliest = std::min(earliest, frameset.frames[camera].time);
    latest = std::max(latest, frameset.frames[camera].time);
  }
  frameset.time = earliest;
  frameset.spread = latest - earliest;
}

}  // namespace

VisionStage::VisionStage(Localizer& localizer, const VisionConfig& config, FrameQueue& frames,
                         PredictionQueue& predictions, VisionQueue& reports)
    : localizer_(localizer),
      min_cameras_(config.synchronizer.min_cameras),
      framesets_(config.synchronizer, config.compensate_motion, config.pulses, frames),
      priors_(config.compensate_motion, predictions),
      reports_(reports),
      perceived_mask_([&localizer] { return localizer.perceived_mask(); }) {
  if (!localizer_.model_has_answer()) {
    spdlog::warn(
        "model {}: it stores no answer to the test frame, so a wrong computation is not detected; "
        "run bevloc store-answer on its file",
        localizer_.model_name());
  }
  check_network();
}

bool VisionStage::step(const drivers::Clock& clock, Duration timeout) {
  framesets_.take_frames(clock, timeout);
  priors_.take_predictions();
  const Time now = clock.now();
  if (auto newest = framesets_.newest(now)) {
    reports_.push(report_on(std::move(*newest)));
    return true;
  }
  report_without_frameset(now);
  return false;
}

void VisionStage::report_without_frameset(Time now) {
  const bool is_displaced = most_stamps_displaced(now);
  // If the check at the start has found a fault, the fault is reported before the first frameset
  // comes.
  const bool is_faulty_start = counters_.network_fault && counters_.framesets == 0;
  VisionReport report;
  report.frame_time = now;
  report.unsynchronized = framesets_.unsynchronized_without_framesets(now);
  report.stamps_jumped = most_jumped_;
  report.stamp_jumps = stamp_jumps_;
  report.network_fault = counters_.network_fault;
  if (report.unsynchronized || is_displaced || is_faulty_start) reports_.push(report);
}

VisionReport VisionStage::report_on(NewestFrameset newest) {
  drivers::Frameset& frameset = newest.frameset;
  ++counters_.framesets;
  counters_.frames_used += frameset.present.count();

  VisionReport report;
  // A frame with a wrong stamp would be matched with the wrong pose. If most time stamps have
  // jumped, the frames are matched, and the tracker has to find out whether the stamps are right.
  report.stamps_jumped = most_jumped_ = most_stamps_jumped(frameset);
  report.stamp_jumps = stamp_jumps_ = stamp_jumps_of_most(frameset);
  if (!report.stamps_jumped) leave_out(jumped_, frameset);
  report.frame_time = frameset.time;
  report.present = frameset.present;
  // These hold also if nothing can be matched now.
  if (const OnlineCalibration* learned = localizer_.online_calibration()) {
    report.calibration_fault = learned->faults();
    report.present &= ~learned->left_out();
  }
  report.skipped = newest.skipped;
  report.unsynchronized = newest.unsynchronized;
  if (counters_.network_fault) {
    report.network_fault = true;
  } else if (frameset.present.none()) {
    ++counters_.refused;
  } else if (const auto prior = priors_.at(frameset)) {
    report.had_prior = true;
    report.prior = prior->map_from_vehicle;
    match(frameset, *prior, report);
    check_network_again(frameset, *prior);
  } else {
    ++counters_.no_prior;
  }
  if (!report.had_prior) forget_unused_images();
  return report;
}

bool VisionStage::most_stamps_jumped(const drivers::Frameset& frameset) {
  const CameraMask displaced = framesets_.displaced().cameras;
  const CameraMask delivering = frameset.present | latest_present_ | displaced;
  jumped_ &= delivering & ~frameset.present;
  jumped_ |= with_jumped_stamps(frameset) | displaced;
  latest_present_ = frameset.present;
  counters_.stamps_jumped = static_cast<unsigned>(jumped_.to_ulong());
  return 2 * jumped_.count() > delivering.count();
}

bool VisionStage::most_stamps_displaced(Time now) {
  const DisplacedFrames& displaced = framesets_.displaced();
  const CameraMask delivering = latest_present_ | displaced.cameras;
  if (2 * displaced.cameras.count() <= delivering.count()) return false;
  if (now < latest_displaced_ + kDisplacedPeriod) return false;
  latest_displaced_ = now;
  most_jumped_ = true;
  stamp_jumps_ = std::max(stamp_jumps_, displaced.stamp_jumps);
  jumped_ |= displaced.cameras;
  counters_.stamps_jumped = static_cast<unsigned>(jumped_.to_ulong());
  return true;
}

void VisionStage::match(const drivers::Frameset& frameset, const Prior& prior,
                        VisionReport& report) {
  const bool driving = std::abs(prior.speed_mps) > kDriving_mps;
  CameraImages images{{},      frameset.present, prior.reference_from_exposure,
                      driving, frameset.time,    prior.driven};
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (frameset.present[camera]) images.images[camera] = frameset.frames[camera].image();
  }
  report.present = localizer_.localize(images, prior.map_from_vehicle, prior.range, solution_);
  report.map_nearby = localizer_.map_nearby();
  if (const OnlineCalibration* learned = localizer_.online_calibration()) {
    report.calibration_fault = learned->faults();
    counters_.calibration_fault = static_cast<unsigned>(learned->faults().to_ulong());
  }
  note_unused_images(frameset);
  if (static_cast<int>(report.present.count()) < min_cameras_) {
    ++counters_.refused;
    return;
  }
  report.match = solution_;
  for (const VisionObserver& observer : observers_) {
    observer({frameset, report, prior.reference_from_exposure, solution_, prior.range,
              localizer_.hypotheses(prior.range), localizer_.map_raster(), perceived_mask_});
  }
}

void VisionStage::check_network() {
  ++counters_.checks;
  const Status status = localizer_.check();
  if (status) return;
  counters_.network_fault = true;
  spdlog::critical("{}", status.error().message);
}

void VisionStage::check_network_again(const drivers::Frameset& frameset, const Prior& prior) {
  if (std::abs(prior.speed_mps) > kStandingSpeed_mps) {
    standing_since_.reset();
    return;
  }
  if (!standing_since_) standing_since_ = frameset.time;
  const bool settled = frameset.time - *standing_since_ >= kSettledStanding;
  if (!settled) return;
  if (latest_check_ != Time::min() && frameset.time - latest_check_ < kCheckPeriod) return;
  latest_check_ = frameset.time;
  check_network();
}

void VisionStage::note_unused_images(const drivers::Frameset& frameset) {
  // If the image of a camera cannot be read, nobody knows what the camera shows.
  const CameraMask readable = localizer_.readable();
  const CameraMask unreadable = frameset.present & ~readable;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (!unreadable[camera]) continue;
    ++counters_.unreadable[camera];
    const std::string& error = localizer_.read_error(camera);
    if (!causes_[camera].is_new(cause_of(error), frameset.time)) continue;
    spdlog::warn("camera {}: unreadable image: {}", kCameraNames[camera], error);
  }
  const auto shown = [&readable](CameraMask mask) {
    return static_cast<unsigned>((mask & readable).to_ulong());
  };
  counters_.frozen = shown(localizer_.frozen());
  counters_.dark = shown(localizer_.with(ViewFault::kDark));
  counters_.blinded = shown(localizer_.with(ViewFault::kBlinded));
  counters_.dirty = shown(localizer_.with(ViewFault::kDirty));
}

void VisionStage::forget_unused_images() {
  counters_.frozen = counters_.dark = counters_.blinded = counters_.dirty = 0;
}

}  // namespace bevloc::firmware
