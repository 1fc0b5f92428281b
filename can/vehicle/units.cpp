#include "can/vehicle/units.h"

#include <numbers>

namespace bevloc::can {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// The dimension, which quantities with the same units share.
enum class Dimension { kSpeed, kTurning, kAngle, kLength };

struct Unit {
  Dimension dimension;
  std::string_view name;
  double factor;
};

constexpr Unit kUnits[] = {
    {Dimension::kSpeed, "m/s", 1.0},
    {Dimension::kSpeed, "mps", 1.0},
    {Dimension::kSpeed, "km/h", 1.0 / 3.6},
    {Dimension::kSpeed, "kmh", 1.0 / 3.6},
    {Dimension::kSpeed, "kph", 1.0 / 3.6},
    {Dimension::kSpeed, "mph", 0.44704},
    {Dimension::kSpeed, "kn", 1852.0 / 3600.0},
    {Dimension::kTurning, "rad/s", 1.0},
    {Dimension::kTurning, "deg/s", kRadPerDeg},
    {Dimension::kTurning, "degree/s", kRadPerDeg},
    {Dimension::kTurning, "degrees/s", kRadPerDeg},
    {Dimension::kTurning, "°/s", kRadPerDeg},
    {Dimension::kAngle, "deg", 1.0},
    {Dimension::kAngle, "degree", 1.0},
    {Dimension::kAngle, "degrees", 1.0},
    {Dimension::kAngle, "°", 1.0},
    {Dimension::kAngle, "rad", 1.0 / kRadPerDeg},
    {Dimension::kAngle, "arcmin", 1.0 / 60.0},
    {Dimension::kLength, "m", 1.0},
    {Dimension::kLength, "cm", 0.01},
    {Dimension::kLength, "mm", 0.001},
};

Dimension dimension_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::kSpeed:
      return Dimension::kSpeed;
    case Quantity::kYawRate:
      return Dimension::kTurning;
    case Quantity::kPosition:
    case Quantity::kHeading:
    case Quantity::kHeadingSigma:
      return Dimension::kAngle;
    case Quantity::kLength:
      break;
  }
  return Dimension::kLength;
}

}  // namespace

std::optional<double> factor_of_unit(Quantity quantity, std::string_view unit) {
  std::string plain;
  for (const char c : unit) {
    if (c == ' ') continue;
    plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  for (const Unit& known : kUnits) {
    if (known.dimension == dimension_of(quantity) && known.name == plain) return known.factor;
  }
  return std::nullopt;
}

std::string_view units_of(Quantity quantity) {
  switch (dimension_of(quantity)) {
    case Dimension::kSpeed:
      return "m/s, km/h, mph or kn";
    case Dimension::kTurning:
      return "rad/s or deg/s";
    case Dimension::kAngle:
      return "deg, rad or arcmin";
    case Dimension::kLength:
      return "m, cm or mm";
  }
  return "";
}

}  // namespace bevloc::can
