// The simulated drive that all cameras of a mock rig look at.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>

#include "common/image.h"
#include "common/time.h"
#include "pipeline/calibration/camera_model.h"
#include "sim/render/ground_tiles.h"
#include "sim/render/renderer.h"
#include "sim/vehicle/drive.h"
#include "sim/world/world.h"

namespace bevloc::drivers {

/// Thread safe. The cameras of one half of the rig take turns at a renderer: two pictures are drawn
/// at a time, in the memory of two, and ground that several cameras see is painted and kept once.
class MockScene {
 public:
  MockScene(std::shared_ptr<const sim::World> world, std::shared_ptr<const sim::Drive> drive,
            const sim::Conditions& conditions, uint64_t noise_seed);

  /// What camera number `camera` (index into kCameraNames) sees at that time of the drive; its
  /// bytes do not depend on what was drawn before. `true_camera` is the real one, which the
  /// calibration file knows only up to its error.
  void draw(int camera, const CameraModel& true_camera, Duration drive_time, RgbImage& image);

 private:
  struct Studio {
    explicit Studio(const std::shared_ptr<sim::GroundTiles>& ground) : renderer(ground) {}

    std::mutex mutex;
    sim::Renderer renderer;  ///< guarded by mutex
  };

  MockScene(std::shared_ptr<const sim::World> world, std::shared_ptr<const sim::Drive> drive,
            const sim::Conditions& conditions, uint64_t noise_seed,
            const std::shared_ptr<sim::GroundTiles>& ground);

  const std::shared_ptr<const sim::World> world_;
  const std::shared_ptr<const sim::Drive> drive_;
  const sim::Conditions conditions_;
  const uint64_t noise_seed_;
  std::array<Studio, 2> studios_;
};

}  // namespace bevloc::drivers
