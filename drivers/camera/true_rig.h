// The rig that the simulated cameras really are, as against the one that was calibrated.
#pragma once

#include <cstdint>

#include "pipeline/calibration/rig.h"

namespace bevloc::drivers {

/// One standard deviation of how far a calibration is from the truth.
struct CalibrationError {
  double rotation_rad = 0.0;    ///< about each axis of the camera
  double translation_m = 0.0;   ///< along each axis of the vehicle
  double relative_focal = 0.0;  ///< of the focal length
};

/// Each camera of `nominal`, moved by an error drawn from `seed`.
Rig true_rig(const Rig& nominal, const CalibrationError& sigma, uint64_t seed);

}  // namespace bevloc::drivers
