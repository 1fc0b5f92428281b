// A camera that sees a simulated world.
#pragma once

#include <memory>
#include <vector>

#include "drivers/camera/mock_scene.h"
#include "drivers/camera/mock_schedule.h"
#include "drivers/camera/paced_camera.h"
#include "pipeline/calibration/camera_model.h"

namespace bevloc::drivers {

struct MockCameraConfig {
  int camera = 0;  ///< index into kCameraNames
  /// The real camera, which the calibration file knows only up to its error.
  CameraModel true_camera;
  CameraTiming timing;
  int buffers = 4;
  std::vector<CameraFault> faults;
};

/// On a real clock pictures are drawn ahead of their time, by the thread that calls next_frame().
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
