// Applies faults to the camera models and the pictures of the simulated cameras.
#pragma once

#include <cstdint>
#include <span>

#include "common/image.h"
#include "pipeline/calibration/camera_model.h"
#include "sim/faults/fault.h"

namespace bevloc::sim {

/// The camera whose picture arrives in the place of `camera`. It is another one if cables are
/// swapped.
int source_camera(int camera, std::span<const Fault> active);

/// The camera after it was turned or moved. It turns in its place: yaw is about the vehicle's
/// vertical axis, to the camera's left. Pitch (downwards) and roll (tilted to the right) are about
/// the camera's own axes.
CameraModel disturbed(CameraModel camera, std::span<const Fault> active);

/// Changes the pixels of a dark or blinded camera. `noise_seed` determines the sensor's noise,
/// which such a picture still has.
void disturb_light(RgbImage& image, std::span<const Fault> active, uint64_t noise_seed);

}  // namespace bevloc::sim
