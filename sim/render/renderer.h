// Draws what a camera on the vehicle sees of a world.
#pragma once

#include <memory>
#include <span>

#include "common/image.h"
#include "common/se2.h"
#include "pipeline/calibration/camera_model.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// Light and weather of one drive.
struct Conditions {
  double sun_azimuth_rad = 0.8;
  double sun_elevation_rad = 0.7;  ///< below 0 it is night and the lamps are on
  double overcast = 0.3;           ///< 0 hard shadows to 1 none
  double rain = 0.0;               ///< 0 dry to 1: wet road mirrors the sky, contrast falls
  double exposure = 1.0;           ///< camera gain error
  double noise_sigma = 2.0;        ///< of a pixel, in 8-bit steps
};

/// Draws the usual conditions: mostly day, some dusk, night and rain.
Conditions random_conditions(uint64_t seed);

/// The vehicle's body over its pose on the ground.
struct BodyMotion {
  double pitch_rad = 0.0;  ///< nose down is positive
  double roll_rad = 0.0;   ///< right side down is positive
  double lift_m = 0.0;
};

class GroundTiles;

/// Not thread safe; several renderers may share one world, and the painted tiles of its ground.
class Renderer {
 public:
  /// With tiles of its own. The world must outlive it.
  explicit Renderer(const World& world);
  explicit Renderer(std::shared_ptr<GroundTiles> ground);
  ~Renderer();

  /// Draws one image. `camera` is the TRUE camera (which calibration error may set apart from the
  /// one the localizer is told). `noise_seed` decides the pixel noise alone.
  void render(const CameraModel& camera, const Se2& map_from_vehicle, const BodyMotion& body,
              double time_s, const Conditions& conditions, uint64_t noise_seed, RgbImage& image);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace bevloc::sim
