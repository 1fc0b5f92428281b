// Signals that messages of both directions have in the same form.
#pragma once

#include <string_view>

#include "can/messages/signal.h"

namespace bevloc::can {

/// A latitude or longitude in [-limit_deg, limit_deg]: the first signal after the E2E header.
constexpr Signal geodetic_signal(std::string_view name, double limit_deg) {
  return {.name = name,
          .start_bit = 16,
          .length_bits = 32,
          .is_signed = true,
          .scale = 1e-7,
          .unit = "deg",
          .min = -limit_deg,
          .max = limit_deg,
          .has_sna = true,
          .comment = "WGS84, of the middle of the rear axle."};
}

/// A heading in [0, 360) degrees: the first signal after the E2E header.
constexpr Signal heading_signal(std::string_view name, std::string_view comment) {
  return {.name = name,
          .start_bit = 16,
          .length_bits = 16,
          .scale = 0.01,
          .unit = "deg",
          .max = 359.99,
          .has_sna = true,
          .comment = comment};
}

/// A standard deviation in steps of 0.01 of its unit.
constexpr Signal std_dev_signal(std::string_view name, int start_bit, std::string_view unit,
                                std::string_view comment) {
  return {.name = name,
          .start_bit = start_bit,
          .length_bits = 16,
          .scale = 0.01,
          .unit = unit,
          .max = 655.34,
          .has_sna = true,
          .comment = comment};
}

}  // namespace bevloc::can
