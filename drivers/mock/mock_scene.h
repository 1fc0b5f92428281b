// The simulated drive that all mock cameras of a rig show.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>

#include "common/cameras.h"
#include "common/image.h"
#include "common/time.h"
#include "drivers/mock/picture_cache.h"
#include "sim/render/ground_tiles.h"
#include "sim/render/mounted_camera.h"
#include "sim/render/picture_look.h"
#include "sim/render/renderer.h"
#include "sim/vehicle/drive.h"
#include "sim/world/world.h"

namespace bevloc::drivers {

/// How the street and the cameras differ from the simulator's own. By default they do not.
struct MockStreet {
  std::array<sim::PictureLook, kCameraCount> looks{};
  bool changes_pictures = false;  ///< whether `looks` changes the pictures
  sim::GroundShape slopes{};      ///< for sim::Drive::ground_at()
  uint64_t digest = 0;            ///< digest of all that makes the street differ
};

/// Thread-safe. There are two renderers, and three cameras share each of them. So two images are
/// drawn at the same time, and memory is needed for two. Ground that several cameras see is painted
/// and kept once.
class MockScene {
 public:
  /// `pictures` keeps the pictures for other scenes, too. It is null if no pictures are kept.
  MockScene(std::shared_ptr<const sim::World> world, std::shared_ptr<const sim::Drive> drive,
            const sim::Conditions& conditions, uint64_t noise_seed,
            std::shared_ptr<PictureCache> pictures = nullptr, const MockStreet& street = {});

  /// Draws the view of camera `camera` (index into kCameraNames) at a time of the drive. The pixels
  /// do not depend on earlier calls. `true_camera` has the true camera models, from which the
  /// calibration file differs by the calibration error.
  void draw(int camera, const sim::MountedCamera& true_camera, Duration drive_time,
            RgbImage& image);

 private:
  /// A renderer that several cameras share.
  struct RendererSlot {
    explicit RendererSlot(const std::shared_ptr<sim::GroundTiles>& ground) : renderer(ground) {}

    std::mutex mutex;
    sim::Renderer renderer;  ///< guarded by mutex
  };

  MockScene(std::shared_ptr<const sim::World> world, std::shared_ptr<const sim::Drive> drive,
            const sim::Conditions& conditions, uint64_t noise_seed,
            std::shared_ptr<PictureCache> pictures, const MockStreet& street,
            const std::shared_ptr<sim::GroundTiles>& ground);

  uint64_t key_of(const sim::MountedCamera& true_camera, const sim::Drive::State& state,
                  const sim::BodyMotion& body, Duration drive_time, uint64_t image_seed) const;

  const std::shared_ptr<const sim::World> world_;
  const std::shared_ptr<const sim::Drive> drive_;
  const sim::Conditions conditions_;
  const uint64_t noise_seed_;
  const MockStreet street_;
  const std::shared_ptr<PictureCache> pictures_;
  const uint64_t digest_;  ///< digest of what all pictures depend on
  std::array<RendererSlot, 2> renderers_;
};

}  // namespace bevloc::drivers
