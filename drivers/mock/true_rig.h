// Makes the true rig of the simulated cameras: the calibrated rig with a calibration error.
#pragma once

#include <cstdint>

#include "pipeline/calibration/rig.h"

namespace bevloc::drivers {

/// Standard deviations of the calibration error.
struct CalibrationError {
  double rotation_rad = 0.0;    ///< about each axis of the camera
  double translation_m = 0.0;   ///< along each axis of the vehicle
  double relative_focal = 0.0;  ///< share of the focal length
};

/// Adds to each camera of `nominal` an error that is drawn with `seed`.
Rig true_rig(const Rig& nominal, const CalibrationError& sigma, uint64_t seed);

}  // namespace bevloc::drivers
