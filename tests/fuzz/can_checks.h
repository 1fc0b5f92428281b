// Judges what the appliance makes of arbitrary frames.
#pragma once

#include <cmath>
#include <variant>

#include "can/bus/controller_monitor.h"
#include "can/bus/socketcan_codec.h"
#include "can/messages/vehicle_decoder.h"
#include "can/messages/vehicle_input.h"
#include "can/publisher/solution_fd.h"

namespace bevloc::fuzz {

inline bool is_finite(const can::VehicleSamples& samples) {
  const auto& odometry = samples.odometry;
  const auto& gnss = samples.gnss;
  return (!odometry ||
          (std::isfinite(odometry->speed_mps) && std::isfinite(odometry->yaw_rate_radps))) &&
         (!gnss || (std::isfinite(gnss->east_m) && std::isfinite(gnss->north_m) &&
                    gnss->sigma_east_m > 0.0 && gnss->sigma_north_m > 0.0));
}

/// Takes what a socket has read as the appliance does. Returns what is wrong, or null.
inline const char* mistake_in(const can::ReadFrame& read, can::VehicleInput& input,
                              can::ControllerMonitor& monitor, Time now) {
  if (const auto* error = std::get_if<can::ErrorFrame>(&read)) monitor.take(*error);
  const auto* frame = std::get_if<can::Frame>(&read);
  if (frame == nullptr) return nullptr;
  if (!can::is_valid_length(frame->format, frame->length)) return "a frame of invalid length";
  if (!is_finite(input.accept({*frame, now}))) return "a sample that is not finite";
  if (frame->length == can::loc_solution::kMessage.length) {
    for (size_t part = 0; part < can::loc_solution::kParts.size(); ++part) {
      can::part_of_solution(*frame, part, {});
    }
  }
  return nullptr;
}

}  // namespace bevloc::fuzz
