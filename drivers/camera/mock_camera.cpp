#include "drivers/camera/mock_camera.h"

#include <utility>

#include "pipeline/calibration/rig.h"
#include "sim/random.h"

namespace bevloc::drivers {
namespace {

CameraDescription description_of(const MockCameraConfig& config) {
  const Intrinsics& intrinsics = config.true_camera.intrinsics;
  return {config.camera, intrinsics.width_px, intrinsics.height_px, config.buffers,
          TimestampOrigin::kSimulated};
}

}  // namespace

MockCamera::MockCamera(std::shared_ptr<const MockScene> scene, const MockCameraConfig& config,
                       Clock& clock)
    : PacedCamera(description_of(config), config.timing.exposure, clock),
      scene_(std::move(scene)),
      config_(config),
      schedule_(config.timing, config.faults),
      renderer_(*scene_->world) {
  set_shelf_life(config.timing.period);
}

Status MockCamera::open(Time now) {
  schedule_.restart(now);
  return {};
}

Status MockCamera::draw(const Delivery& delivery, RgbImage& image) {
  const Duration drive_time = delivery.scene_time - config_.timing.drive_start;
  const double time_s = to_seconds(drive_time);
  const uint64_t camera_seed = sim::seed_for(scene_->seed, kCameraNames[config_.camera]);
  const uint64_t noise_seed =
      sim::mix_seed(camera_seed ^ static_cast<uint64_t>(drive_time.count()));
  renderer_.render(config_.true_camera, scene_->drive->at(time_s).map_from_vehicle,
                   scene_->drive->body_at(time_s), time_s, scene_->conditions, noise_seed, image);
  return {};
}

}  // namespace bevloc::drivers
