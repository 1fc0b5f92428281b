// The units of signals in DBC files, and their factors to the units that bevloc computes with.
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

/// Returns the factor from this unit to that of the quantity, or nothing for an unknown unit. Case
/// and spaces do not matter.
std::optional<double> factor_of_unit(Quantity quantity, std::string_view unit);

/// Returns the known units of a quantity, such as "m/s, km/h, mph or kn".
std::string_view units_of(Quantity quantity);

}  // namespace bevloc::can
