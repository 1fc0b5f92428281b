// What may be wrong in a sample: each nuisance has a strength, and sets of them have names.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/result.h"
#include "common/se2.h"

namespace bevloc::sim {

/// What is left of a camera's calibration error on a vehicle, one sigma.
struct CalibrationSigma {
  double rotation_rad = radians(0.12);
  double position_m = 0.008;
  double relative_focal = 0.002;
};

/// How the body stands over its wheels, one sigma.
struct BodySigma {
  double tilt_rad = radians(0.35);  ///< of pitch and of roll
  double lift_m = 0.025;
};

/// kUsual is random_conditions(); kNight and kRain are as dark and as wet as its nights and rains,
/// and usual in all else.
enum class Weather : uint8_t { kUsual, kClearNoon, kNight, kRain };

/// How the map that the localizer is given differs from the world's own.
struct MapErrors {
  double omission = 0.0;       ///< share of the elements that are missing
  double ghost = 0.0;          ///< share that have a double beside them which nobody painted
  double shift_sigma_m = 0.0;  ///< of east and of north, changing over tens of metres

  bool operator==(const MapErrors&) const = default;
};

/// Cameras that are not there; their images are black and the camera mask says so.
struct MissingCameras {
  double probability = 0.0;
  int most = 2;  ///< from one to this many, drawn with replacement
};

/// Cameras that expose within `spread_s` before or after the time of the pose, while the vehicle
/// drives at 5 to 20 m/s and turns a little. Zero: all at once.
struct Desynchronisation {
  double spread_s = 0.0;
  bool compensated = true;  ///< whether the sample says how the vehicle moved, as odometry has it
};

/// The defaults are what a sample usually has.
struct Nuisances {
  CalibrationSigma calibration;
  BodySigma body;
  Weather weather = Weather::kUsual;
  double paint_wear_factor = 1.0;  ///< on the wear of all paint
  int extra_vehicles = 0;          ///< that stand on the lanes around the vehicle
  MapErrors map_errors;
  MissingCameras missing_cameras;
  Desynchronisation desynchronisation;
};

/// What a table has a row for. All but kStandard (all at its usual strength: now and then one or
/// two cameras are missing, and they expose within 10 ms) and kClean (nothing is wrong) change one
/// thing of kSixCameras.
enum class NuisanceSet : uint8_t {
  kStandard,
  kSixCameras,
  kClean,
  kNight,
  kRain,
  kOcclusion,
  kWornPaint,
  kMapErrors,
  kCalibration,
  kPitch,
  kMissingCamera,
  kUnsynchronised,
  kUnsynchronisedUncompensated,
};

inline constexpr size_t kNuisanceSets = 13;

std::array<NuisanceSet, kNuisanceSets> all_nuisance_sets();
Nuisances nuisances_of(NuisanceSet set);
std::string_view name_of(NuisanceSet set);
/// What the set changes, in a few words.
std::string_view describe(NuisanceSet set);
/// Fails with the names that are known.
Result<NuisanceSet> nuisance_set_from(std::string_view name);

}  // namespace bevloc::sim
