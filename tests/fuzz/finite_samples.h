// Judges what a decoder made of arbitrary frames.
#pragma once

#include <cmath>

#include "can/messages/vehicle_decoder.h"

namespace bevloc::fuzz {

inline bool is_finite(const can::VehicleSamples& samples) {
  const auto& odometry = samples.odometry;
  const auto& gnss = samples.gnss;
  return (!odometry ||
          (std::isfinite(odometry->speed_mps) && std::isfinite(odometry->yaw_rate_radps))) &&
         (!gnss || (std::isfinite(gnss->east_m) && std::isfinite(gnss->north_m) &&
                    gnss->sigma_east_m > 0.0 && gnss->sigma_north_m > 0.0));
}

}  // namespace bevloc::fuzz
