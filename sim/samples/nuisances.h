// The nuisances of a sample (calibration error, weather, map errors, ...) and named sets of them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/result.h"
#include "common/se2.h"
#include "sim/samples/camera_looks.h"
#include "sim/samples/map_habits.h"
#include "sim/samples/street_clutter.h"

namespace bevloc::sim {

/// The residual calibration error of a camera on a vehicle, one sigma.
struct CalibrationSigma {
  double rotation_rad = radians(0.12);
  double position_m = 0.008;
  double relative_focal = 0.002;
};

/// Tilt and lift of the body over its wheels, one sigma.
struct BodySigma {
  double tilt_rad = radians(0.35);  ///< sigma of pitch and of roll
  double lift_m = 0.025;
};

/// The ground around the vehicle, uniform between minus and plus these values.
struct Slopes {
  double along_per_m = 0.0;
  double across_per_m = 0.0;
  double twist_per_m = 0.0;
};

/// kUsual is random_conditions(). kNight and kRain are the same, but always at night or always with
/// rain. kClearNoon has a high sun, no clouds or rain, exact exposure and little noise.
enum class Weather : uint8_t { kUsual, kClearNoon, kNight, kRain };

/// Errors of the localizer's map against the world's own map.
struct MapErrors {
  double omission = 0.0;       ///< share of elements that are missing
  double ghost = 0.0;          ///< share of elements with an unpainted copy beside them
  double shift_sigma_m = 0.0;  ///< sigma of the shift per axis, which varies over tens of metres

  bool operator==(const MapErrors&) const = default;
};

/// Missing cameras. Their images are black and their bits in the camera mask are clear.
struct MissingCameras {
  double probability = 0.0;  ///< probability that cameras are missing
  int most = 2;              ///< 1 to this many cameras are drawn, with replacement
};

/// Each camera exposes within `spread_s` before or after the time of the pose, while the vehicle
/// drives at 5 to 20 m/s and may turn. With 0 all cameras expose at the time of the pose.
struct Desynchronisation {
  double spread_s = 0.0;
  bool compensated = true;  ///< whether the sample carries the vehicle's motion from odometry
};

/// All nuisances of a sample. The defaults are the usual strengths.
struct Nuisances {
  double rig_variety = 0.0;  ///< variety of random_rig(); 0 for the simulator's own rig
  CalibrationSigma calibration;
  BodySigma body;
  Slopes slopes;
  Weather weather = Weather::kUsual;
  double paint_wear_factor = 1.0;  ///< multiplies the wear of all paint
  int extra_vehicles = 0;          ///< vehicles that stand on the lanes around the vehicle
  MapErrors map_errors;
  MapHabits map_habits;
  StreetClutter clutter;
  double verge_share = 0.0;  ///< share of road edges that grass or dirt overgrows, up to 1.5 m
  CameraLooks looks;
  double noise_factor = 1.0;  ///< multiplies the noise of the pixels
  MissingCameras missing_cameras;
  Desynchronisation desynchronisation;
};

/// Named sets of nuisances; evaluation tables have one row per set. kStandard has every nuisance at
/// its usual strength: sometimes one or two cameras are missing, and each camera exposes
/// within 10 ms of the pose's time. kClean has none. Every other set changes one nuisance of
/// kSixCameras.
enum class NuisanceSet : uint8_t {
  kStandard,
  kSixCameras,
  kClean,
  kNight,
  kRain,
  kOcclusion,
  kWornPaint,
  kMapErrors,
  kMapHabits,
  kColour,
  kClutter,
  kCalibration,
  kPitch,
  kSlopes,
  kRigs,
  kMissingCamera,
  kUnsynchronised,
  kUnsynchronisedUncompensated,
};

inline constexpr size_t kNuisanceSets = 18;

std::array<NuisanceSet, kNuisanceSets> all_nuisance_sets();
Nuisances nuisances_of(NuisanceSet set);
std::string_view name_of(NuisanceSet set);
/// A short description of the set.
std::string_view describe(NuisanceSet set);
/// Fails for an unknown name; the error lists the known names.
Result<NuisanceSet> nuisance_set_from(std::string_view name);

}  // namespace bevloc::sim
