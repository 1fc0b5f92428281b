// The units of signals in DBC files, and what they are in the units that bevloc computes with.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace bevloc::can {

enum class Quantity {
  kSpeed,         ///< m/s
  kYawRate,       ///< rad/s
  kPosition,      ///< degrees: latitude, longitude
  kHeading,       ///< degrees
  kHeadingSigma,  ///< degrees
  kLength,        ///< m: the sigma of a position
};

/// The factor from this unit; nothing for an unknown one. Case and spaces do not matter.
std::optional<double> factor_of_unit(Quantity quantity, std::string_view unit);

/// "m/s, km/h, mph or kn".
std::string_view units_of(Quantity quantity);

}  // namespace bevloc::can
