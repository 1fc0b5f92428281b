// A mock camera that shows a simulated world.
#pragma once

#include <memory>
#include <vector>

#include "drivers/camera/paced_camera.h"
#include "drivers/mock/mock_scene.h"
#include "drivers/mock/mock_schedule.h"
#include "pipeline/calibration/camera_model.h"

namespace bevloc::drivers {

struct MockCameraConfig {
  int camera = 0;  ///< index into kCameraNames
  /// The true camera model. The calibration file differs from it by the calibration error.
  CameraModel true_camera;
  CameraTiming timing;
  int buffers = kDefaultFrameBuffers;
  std::vector<CameraFault> faults;
};

/// With a real clock, images are drawn ahead of time in the thread that calls next_frame().
class MockCamera final : public PacedCamera {
 public:
  MockCamera(std::shared_ptr<MockScene> scene, const MockCameraConfig& config, Clock& clock);

 private:
  Status open(Time now) override;
  std::optional<Delivery> next_delivery() override { return schedule_.next(); }
  Status draw(const Delivery& delivery, RgbImage& image) override;

  const std::shared_ptr<MockScene> scene_;
  const MockCameraConfig config_;
  MockSchedule schedule_;
};

}  // namespace bevloc::drivers
