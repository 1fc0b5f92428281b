// From light to the camera's 8-bit image.
#pragma once

#include <cstdint>

#include "common/image.h"
#include "sim/render/lighting.h"
#include "sim/render/picture.h"
#include "sim/render/view.h"

namespace bevloc::sim {

/// The camera's own look: it stays the same from frame to frame.
struct Sensor {
  Rgb gain{1.0F, 1.0F, 1.0F};
  float blur = 0.1F;       ///< weight of each neighbouring pixel, per direction
  float vignette = 0.25F;  ///< loss of light per squared ray slope
};

/// Drawn from the camera's place in the world, a little different for each.
Sensor sensor_of(uint64_t world_seed, const CameraModel& camera);

void develop(const View& view, const Lighting& lighting, const Sensor& sensor, uint64_t noise_seed,
             Picture& picture, RgbImage& image);

}  // namespace bevloc::sim
