// A mock camera that shows a simulated world.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "drivers/camera/paced_camera.h"
#include "drivers/mock/mock_scene.h"
#include "drivers/mock/mock_schedule.h"
#include "pipeline/calibration/rig.h"
#include "sim/faults/fault_board.h"
#include "sim/faults/lens_dirt.h"

namespace bevloc::drivers {

struct MockCameraConfig {
  int camera = 0;  ///< index into kCameraNames
  /// The true cameras. The calibration file differs from them by the calibration error. All are
  /// needed, because cables may be swapped.
  Rig true_rig;
  CameraTiming timing;
  int buffers = kDefaultFrameBuffers;
  std::shared_ptr<const sim::FaultBoard> faults;  ///< null without faults
  uint64_t fault_seed = 0;  ///< chooses dirt, and noise of dark and blinded pictures
};

/// With a real clock, images are drawn ahead of time in the thread that calls next_frame().
class MockCamera final : public PacedCamera {
 public:
  MockCamera(std::shared_ptr<MockScene> scene, const MockCameraConfig& config, Clock& clock);

 private:
  Status open(Time now) override;
  std::optional<Delivery> next_delivery() override { return schedule_.next(); }
  Status draw(const Delivery& delivery, RgbImage& image) override;
  Duration drive_time(Time time) const;
  void cover_lens(int source, double share, RgbImage& image);

  const std::shared_ptr<MockScene> scene_;
  const MockCameraConfig config_;
  Clock& clock_;
  MockSchedule schedule_;
  std::optional<sim::LensDirt> dirt_;
  int dirty_camera_ = -1;  ///< the camera to which the pattern in dirt_ belongs
};

}  // namespace bevloc::drivers
