#include "drivers/mock/mock_camera.h"

#include <utility>
#include <vector>

#include "sim/faults/drive_clock.h"
#include "sim/faults/picture_faults.h"
#include "sim/random.h"

namespace bevloc::drivers {
namespace {

CameraDescription description_of(const MockCameraConfig& config) {
  const Intrinsics& intrinsics = config.true_rig.cameras[config.camera].intrinsics;
  return {config.camera, intrinsics.width_px, intrinsics.height_px, config.buffers};
}

}  // namespace

MockCamera::MockCamera(std::shared_ptr<MockScene> scene, const MockCameraConfig& config,
                       Clock& clock)
    : PacedCamera(description_of(config), config.timing.exposure, clock),
      scene_(std::move(scene)),
      config_(config),
      clock_(clock),
      schedule_(config.timing, config.camera, config.faults) {
  set_max_lateness(config.timing.period);
}

Status MockCamera::open(Time now) {
  schedule_.restart(now);
  return {};
}

/// Returns the time of the drive that a picture of this time shows.
Duration MockCamera::drive_time(Time time) const {
  const Duration elapsed = time - config_.timing.drive_start;
  const auto faults = config_.faults->all(sim::FaultInput::kClock);
  if (faults.empty()) return elapsed;
  return from_seconds(sim::drive_time_s(to_seconds(elapsed), faults));
}

Status MockCamera::draw(const Delivery& delivery, RgbImage& image) {
  if (!config_.faults) {
    scene_->draw(config_.camera, config_.true_rig.cameras[config_.camera],
                 delivery.scene_time - config_.timing.drive_start, image);
    return {};
  }
  const auto now_s = [this] { return to_seconds(clock_.now() - config_.timing.drive_start); };
  if (config_.faults->hang(sim::FaultKind::kHangCapture, config_.camera, now_s)) {
    return fail("camera {}: hung until the end of the drive", kCameraNames[config_.camera]);
  }
  const Duration scene_time = drive_time(delivery.scene_time);
  const Duration true_time = schedule_.true_exposure_start(delivery) - config_.timing.drive_start;
  const double time_s = to_seconds(true_time);
  // A fault of the optics stays with its camera, even if the cable is plugged into another port.
  const int source =
      sim::source_camera(config_.camera, config_.faults->active(sim::FaultInput::kCamera, time_s));
  const std::vector<sim::Fault> active = config_.faults->active_on_camera(source, time_s);
  const CameraModel& camera = config_.true_rig.cameras[source];
  if (camera.intrinsics.width_px != image.width || camera.intrinsics.height_px != image.height) {
    return fail("camera {}: found a picture of {} x {} pixels from camera {}, wanted {} x {}",
                kCameraNames[config_.camera], camera.intrinsics.width_px,
                camera.intrinsics.height_px, kCameraNames[source], image.width, image.height);
  }
  const CameraModel disturbed = sim::disturbed(camera, active);
  scene_->draw(source, {disturbed, camera}, scene_time, image);
  for (const sim::Fault& fault : active) {
    if (fault.kind == sim::FaultKind::kCameraDirty) cover_lens(source, fault.amounts.share, image);
  }
  const uint64_t camera_seed = sim::seed_for(config_.fault_seed, kCameraNames[source]);
  sim::disturb_light(image, active,
                     sim::mix_seed(camera_seed ^ static_cast<uint64_t>(scene_time.count())));
  return {};
}

void MockCamera::cover_lens(int source, double share, RgbImage& image) {
  if (!dirt_ || dirt_->share() != share || dirty_camera_ != source) {
    dirty_camera_ = source;
    dirt_.emplace(image.width, image.height, share,
                  sim::seed_for(config_.fault_seed, kCameraNames[source]));
  }
  dirt_->cover(image);
}

}  // namespace bevloc::drivers
