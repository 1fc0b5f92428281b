// Renders the image that a camera on the vehicle sees of a world.
#pragma once

#include <memory>
#include <span>

#include "common/image.h"
#include "common/se2.h"
#include "sim/render/conditions.h"
#include "sim/render/mounted_camera.h"
#include "sim/vehicle/stance.h"
#include "sim/world/world.h"

namespace bevloc::sim {

class GroundTiles;

/// One thread. Renderers in different threads may share one world and its GroundTiles.
class Renderer {
 public:
  /// Makes its own ground tiles. The world must outlive the renderer.
  explicit Renderer(const World& world);
  /// Shares ground tiles with other renderers.
  explicit Renderer(std::shared_ptr<GroundTiles> ground);
  ~Renderer();

  /// Renders one image. `camera` is the true camera, which may differ from the calibration that the
  /// localizer gets. `map_from_vehicle` must be finite. `time_s` places the traffic. `noise_seed`
  /// affects nothing but the pixel noise. `image` is resized to the camera's size if necessary.
  void render(const MountedCamera& camera, const Se2& map_from_vehicle, const Stance& stance,
              double time_s, const Conditions& conditions, uint64_t noise_seed, RgbImage& image);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace bevloc::sim
