#include "drivers/mock/mock_camera.h"

#include <utility>

namespace bevloc::drivers {
namespace {

CameraDescription description_of(const MockCameraConfig& config) {
  const Intrinsics& intrinsics = config.true_camera.intrinsics;
  return {config.camera, intrinsics.width_px, intrinsics.height_px, config.buffers,
          TimestampOrigin::kSimulated};
}

}  // namespace

MockCamera::MockCamera(std::shared_ptr<MockScene> scene, const MockCameraConfig& config,
                       Clock& clock)
    : PacedCamera(description_of(config), config.timing.exposure, clock),
      scene_(std::move(scene)),
      config_(config),
      schedule_(config.timing, config.faults) {
  set_max_lateness(config.timing.period);
}

Status MockCamera::open(Time now) {
  schedule_.restart(now);
  return {};
}

Status MockCamera::draw(const Delivery& delivery, RgbImage& image) {
  scene_->draw(config_.camera, config_.true_camera,
               delivery.scene_time - config_.timing.drive_start, image);
  return {};
}

}  // namespace bevloc::drivers
