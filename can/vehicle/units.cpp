#include "can/vehicle/units.h"

#include <numbers>

namespace bevloc::can {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

struct Unit {
  Quantity quantity;
  std::string_view name;
  double factor;
};

constexpr Unit kUnits[] = {
    {Quantity::kSpeed, "m/s", 1.0},
    {Quantity::kSpeed, "mps", 1.0},
    {Quantity::kSpeed, "km/h", 1.0 / 3.6},
    {Quantity::kSpeed, "kmh", 1.0 / 3.6},
    {Quantity::kSpeed, "kph", 1.0 / 3.6},
    {Quantity::kSpeed, "mph", 0.44704},
    {Quantity::kSpeed, "kn", 1852.0 / 3600.0},
    {Quantity::kYawRate, "rad/s", 1.0},
    {Quantity::kYawRate, "deg/s", kRadPerDeg},
    {Quantity::kYawRate, "degree/s", kRadPerDeg},
    {Quantity::kYawRate, "degrees/s", kRadPerDeg},
    {Quantity::kYawRate, "°/s", kRadPerDeg},
    {Quantity::kAngle, "deg", 1.0},
    {Quantity::kAngle, "degree", 1.0},
    {Quantity::kAngle, "degrees", 1.0},
    {Quantity::kAngle, "°", 1.0},
    {Quantity::kAngle, "rad", 1.0 / kRadPerDeg},
    {Quantity::kAngle, "arcmin", 1.0 / 60.0},
    {Quantity::kLength, "m", 1.0},
    {Quantity::kLength, "cm", 0.01},
    {Quantity::kLength, "mm", 0.001},
};

}  // namespace

std::optional<double> factor_of_unit(Quantity quantity, std::string_view unit) {
  std::string plain;
  for (const char c : unit) {
    if (c == ' ') continue;
    plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  for (const Unit& known : kUnits) {
    if (known.quantity == quantity && known.name == plain) return known.factor;
  }
  return std::nullopt;
}

std::string_view units_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::kSpeed:
      return "m/s, km/h, mph or kn";
    case Quantity::kYawRate:
      return "rad/s or deg/s";
    case Quantity::kAngle:
      return "deg, rad or arcmin";
    case Quantity::kLength:
      return "m, cm or mm";
  }
  return "";
}

}  // namespace bevloc::can
