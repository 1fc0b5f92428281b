// A camera that sees a simulated world.
#pragma once

#include <memory>
#include <vector>

#include "drivers/camera/mock_schedule.h"
#include "drivers/camera/paced_camera.h"
#include "pipeline/calibration/camera_model.h"
#include "sim/render/renderer.h"
#include "sim/vehicle/drive.h"
#include "sim/world/world.h"

namespace bevloc::drivers {

/// What the cameras of one mock rig share, unchanging while they live.
struct MockScene {
  std::shared_ptr<const sim::World> world;
  std::shared_ptr<const sim::Drive> drive;
  sim::Conditions conditions;
  uint64_t seed = 0;  ///< of the pixel noise
};

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
  MockCamera(std::shared_ptr<const MockScene> scene, const MockCameraConfig& config, Clock& clock);

 private:
  Status open(Time now) override;
  std::optional<Delivery> next_delivery() override { return schedule_.next(); }
  Status draw(const Delivery& delivery, RgbImage& image) override;

  const std::shared_ptr<const MockScene> scene_;
  const MockCameraConfig config_;
  MockSchedule schedule_;
  sim::Renderer renderer_;
};

}  // namespace bevloc::drivers
