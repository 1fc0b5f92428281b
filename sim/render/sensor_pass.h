// Converts radiance to the camera's 8-bit image.
#pragma once

#include <cstdint>

#include "common/image.h"
#include "sim/render/lighting.h"
#include "sim/render/linear_image.h"
#include "sim/render/view.h"

namespace bevloc::sim {

/// The properties of one camera, constant over all images.
struct Sensor {
  Rgb gain{1.0F, 1.0F, 1.0F};
  float blur = 0.1F;       ///< weight of each neighbouring pixel, per direction
  float vignette = 0.25F;  ///< loss of light per squared slope of the ray
};

/// Draws the properties of a camera from the world's seed and its mounting, slightly different for
/// each camera.
Sensor sensor_of(uint64_t world_seed, const CameraModel& camera);

/// Applies blur, vignette, gamma and noise. Resizes `image` if necessary.
void develop(const View& view, const Lighting& lighting, const Sensor& sensor, uint64_t noise_seed,
             LinearImage& linear, RgbImage& image);

}  // namespace bevloc::sim
