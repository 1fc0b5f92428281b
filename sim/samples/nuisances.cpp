#include "sim/samples/nuisances.h"

#include <algorithm>
#include <vector>

#include <fmt/ranges.h>

namespace bevloc::sim {
namespace {

// What sets with several values change.
constexpr MapErrors kWrongMap{.omission = 0.1, .ghost = 0.1, .shift_sigma_m = 0.15};
constexpr MapHabits kHabitualMap{.short_divider = 0.4,
                                 .long_divider = 0.1,
                                 .broken_divider = 0.2,
                                 .inner_boundary = 0.4,
                                 .closed_mouth = 0.2,
                                 .double_boundary = 0.3};
constexpr CameraLooks kColourful{
    .cast = 0.25, .least_saturation = 0.0, .most_saturation = 1.5, .grey_share = 0.25};
constexpr StreetClutter kCluttered{.kerb_line = 0.3,
                                   .studs = 0.25,
                                   .crossing_edges = 0.5,
                                   .box = 0.08,
                                   .works = 0.05,
                                   .bollards = 0.15,
                                   .railing = 0.15,
                                   .shadow = 0.3,
                                   .people_per_100m = 2.0};
constexpr Slopes kSloping{
    .along_per_m = 1.0 / 300.0, .across_per_m = 1.0 / 200.0, .twist_per_m = 1.0 / 1000.0};

struct Entry {
  NuisanceSet set;
  std::string_view name;
  std::string_view description;
  /// Makes this set of the usual nuisances.
  void (*change)(Nuisances& nuisances);
};

constexpr std::array<Entry, kNuisanceSets> kEntries{{
    {NuisanceSet::kStandard, "standard",
     "usual nuisances; 1 or 2 cameras missing in 15 %, exposures within 10 ms",
     [](Nuisances& nuisances) {
       nuisances.missing_cameras.probability = 0.15;
       nuisances.desynchronisation.spread_s = 0.01;
     }},
    {NuisanceSet::kSixCameras, "six_cameras", "usual nuisances, six cameras that expose at once",
     [](Nuisances&) {}},
    {NuisanceSet::kClean, "clean", "exact calibration, level body, clear noon",
     [](Nuisances& nuisances) {
       nuisances.calibration = {0.0, 0.0, 0.0};
       nuisances.body = {0.0, 0.0};
       nuisances.weather = Weather::kClearNoon;
     }},
    {NuisanceSet::kNight, "night", "always night",
     [](Nuisances& nuisances) { nuisances.weather = Weather::kNight; }},
    {NuisanceSet::kRain, "rain", "always rain",
     [](Nuisances& nuisances) { nuisances.weather = Weather::kRain; }},
    {NuisanceSet::kOcclusion, "occlusion", "ten more standing vehicles",
     [](Nuisances& nuisances) { nuisances.extra_vehicles = 10; }},
    {NuisanceSet::kWornPaint, "worn_paint", "paint twice as worn",
     [](Nuisances& nuisances) { nuisances.paint_wear_factor = 2.0; }},
    {NuisanceSet::kMapErrors, "map_errors", "10 % missing, 10 % doubled, shifted by 0.15 m",
     [](Nuisances& nuisances) { nuisances.map_errors = kWrongMap; }},
    {NuisanceSet::kMapHabits, "map_habits",
     "dividers end 5 to 30 m early or late, boundaries up to 0.7 m inside, across mouths, double",
     [](Nuisances& nuisances) { nuisances.map_habits = kHabitualMap; }},
    {NuisanceSet::kColour, "colour", "casts up to 25 %, saturation 0 to 1.5, a quarter grey",
     [](Nuisances& nuisances) { nuisances.looks = kColourful; }},
    {NuisanceSet::kClutter, "clutter",
     "lines at kerbs, studs, boxes, works, hard shadows, bollards, railings, people",
     [](Nuisances& nuisances) { nuisances.clutter = kCluttered; }},
    {NuisanceSet::kCalibration, "calibration", "cameras off by 0.2 degrees and 2 cm",
     [](Nuisances& nuisances) {
       nuisances.calibration.rotation_rad = radians(0.2);
       nuisances.calibration.position_m = 0.02;
     }},
    {NuisanceSet::kPitch, "pitch", "body pitches and rolls by 1 degree",
     [](Nuisances& nuisances) { nuisances.body.tilt_rad = radians(1.0); }},
    {NuisanceSet::kSlopes, "slopes", "crests and sags of 300 m radius and more, camber, banks",
     [](Nuisances& nuisances) { nuisances.slopes = kSloping; }},
    {NuisanceSet::kRigs, "rigs", "another rig for each frame, half as various as in training",
     [](Nuisances& nuisances) { nuisances.rig_variety = 0.5; }},
    {NuisanceSet::kMissingCamera, "missing_camera", "exactly one camera missing",
     [](Nuisances& nuisances) { nuisances.missing_cameras = {.probability = 1.0, .most = 1}; }},
    {NuisanceSet::kUnsynchronised, "unsynchronised", "each camera within 50 ms of the pose's time",
     [](Nuisances& nuisances) { nuisances.desynchronisation.spread_s = 0.05; }},
    {NuisanceSet::kUnsynchronisedUncompensated, "unsynchronised_uncompensated",
     "the same without motion compensation",
     [](Nuisances& nuisances) {
       nuisances.desynchronisation = {.spread_s = 0.05, .compensated = false};
     }},
}};

const Entry& entry_of(NuisanceSet set) {
  return kEntries[static_cast<size_t>(set)];
}

}  // namespace

std::array<NuisanceSet, kNuisanceSets> all_nuisance_sets() {
  std::array<NuisanceSet, kNuisanceSets> sets{};
  std::ranges::transform(kEntries, sets.begin(), &Entry::set);
  return sets;
}

Nuisances nuisances_of(NuisanceSet set) {
  Nuisances nuisances;
  entry_of(set).change(nuisances);
  return nuisances;
}

std::string_view name_of(NuisanceSet set) {
  return entry_of(set).name;
}

std::string_view describe(NuisanceSet set) {
  return entry_of(set).description;
}

Result<NuisanceSet> nuisance_set_from(std::string_view name) {
  const auto found = std::ranges::find(kEntries, name, &Entry::name);
  if (found != kEntries.end()) return found->set;
  std::vector<std::string_view> names;
  std::ranges::transform(kEntries, std::back_inserter(names), &Entry::name);
  return fail("set: found \"{}\", wanted one of {}", name, fmt::join(names, ", "));
}

}  // namespace bevloc::sim
