#include "evaluation/drive/drive_config.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <sys/un.h>

#include "common/time.h"
#include "evaluation/drive/fault_config.h"
#include "sim/world/world_generator.h"

namespace bevloc::evaluation {
namespace {

sim::Conditions read_conditions(std::optional<YamlMap> yaml) {
  sim::Conditions conditions;
  if (!yaml) return conditions;
  conditions.sun_azimuth_rad = radians(yaml->optional<double>(
      "sun_azimuth_deg", degrees(conditions.sun_azimuth_rad), between(-180.0, 360.0)));
  conditions.sun_elevation_rad = radians(yaml->optional<double>(
      "sun_elevation_deg", degrees(conditions.sun_elevation_rad), between(-90.0, 90.0)));
  conditions.overcast = yaml->optional<double>("overcast", conditions.overcast, between(0.0, 1.0));
  conditions.rain = yaml->optional<double>("rain", conditions.rain, between(0.0, 1.0));
  conditions.exposure = yaml->optional<double>("exposure", conditions.exposure, between(0.1, 10.0));
  conditions.noise_sigma =
      yaml->optional<double>("noise_sigma", conditions.noise_sigma, between(0.0, 50.0));
  return conditions;
}

drivers::CalibrationError read_calibration_error(std::optional<YamlMap> yaml) {
  drivers::CalibrationError sigma;
  if (!yaml) return sigma;
  sigma.rotation_rad = radians(yaml->optional<double>("rotation_deg", 0.0, between(0.0, 5.0)));
  sigma.translation_m = yaml->optional<double>("translation_m", 0.0, between(0.0, 0.5));
  sigma.relative_focal = yaml->optional<double>("relative_focal", 0.0, between(0.0, 0.1));
  return sigma;
}

StreetConfig read_street(std::optional<YamlMap> yaml) {
  StreetConfig street;
  if (!yaml) return street;
  if (yaml->has("seed")) street.seed = yaml->require<uint64_t>("seed");
  street.looks = yaml->optional<double>("looks", 0.0, between(0.0, 2.0));
  street.slopes = yaml->optional<double>("slopes", 0.0, between(0.0, 2.0));
  street.photos = yaml->optional<std::string>("photos", "");
  return street;
}

std::array<Duration, kCameraCount> read_offsets(YamlMap& yaml) {
  std::array<Duration, kCameraCount> offsets{};
  const auto offsets_ms = yaml.optional_list<double>(
      "exposure_offsets_ms", std::vector<double>(kCameraCount), kCameraCount, between(0.0, 50.0));
  std::ranges::transform(offsets_ms, offsets.begin(), from_milliseconds);
  return offsets;
}

/// Returns false if the map is a file.
bool read_procedural_map(YamlMap& map, SimulationConfig& simulation) {
  if (!map.has_in_place_of("procedural_seed")) return false;
  simulation.town_seed =
      map.require<uint64_t>("procedural_seed", between(uint64_t{0}, sim::kFirstTrainingSeed - 1));
  return true;
}

sim::StopTimes read_stops(YamlMap& yaml) {
  constexpr double kLongest_s = 1e6;
  const sim::StopTimes stops;
  const auto times = yaml.optional_list<double>("stops_s", {stops.shortest_s, stops.longest_s}, 2,
                                                between(0.1, kLongest_s));
  if (times[0] > times[1]) {
    yaml.reject("stops_s", fmt::format("{} to {}", times[0], times[1]), "the shortest time first");
  }
  return {times[0], times[1]};
}

sim::Pace read_pace(YamlMap& yaml) {
  if (!yaml.has("pace")) return {};
  std::vector<sim::PacePoint> points;
  for (YamlMap& point : yaml.require_map_list("pace")) {
    const auto at_s = point.require<double>("at_s", between(0.0, kLongestDrive_s));
    const auto pace = point.require<double>("pace", between(-1.0, 1.0));
    if (!points.empty() && at_s <= points.back().at_s) {
      point.reject("at_s", fmt::format("{}", at_s), "a time after that of the point before");
      return {};
    }
    points.push_back({at_s, pace});
  }
  return sim::Pace(std::move(points));
}

void read_simulation(YamlMap yaml, SimulationConfig& simulation) {
  simulation.seed = yaml.require<uint64_t>("seed");
  simulation.duration_s =
      yaml.require<double>("duration_s", between(kShortestDrive_s, kLongestDrive_s));
  simulation.stops = read_stops(yaml);
  simulation.pace = read_pace(yaml);
  simulation.conditions = read_conditions(yaml.optional_map("conditions"));
  simulation.calibration_error = read_calibration_error(yaml.optional_map("calibration_error"));
  simulation.street = read_street(yaml.optional_map("street"));
  simulation.exposure_offsets = read_offsets(yaml);
  constexpr size_t kLongestSocket = sizeof(sockaddr_un::sun_path) - 1;
  simulation.fault_socket = yaml.optional<std::string>(
      "fault_socket", "",
      not_empty(fmt::format("the name of a socket, 1 to {} bytes", kLongestSocket),
                kLongestSocket));
  simulation.faults.clear();
  if (yaml.has("faults")) {
    for (YamlMap& fault : yaml.require_map_list("faults")) {
      simulation.faults.push_back(read_fault(fault));
    }
  }
}

template <typename Load>
Result<DriveConfig> load_with_simulation(const Load& load) {
  std::optional<SimulationConfig> simulation;
  auto config = load(simulation_reader(simulation));
  if (!config) return tl::unexpected(config.error());
  return DriveConfig{std::move(*config), std::move(simulation)};
}

}  // namespace

firmware::SimulationReader simulation_reader(std::optional<SimulationConfig>& simulation) {
  const auto read = std::make_shared<SimulationConfig>();
  return {[read](YamlMap& map) { return read_procedural_map(map, *read); },
          [read, &simulation](YamlMap yaml) {
            read_simulation(std::move(yaml), *read);
            simulation = *read;
          }};
}

Result<DriveConfig> load_drive_config(const std::filesystem::path& file) {
  return load_with_simulation([&](const firmware::SimulationReader& reader) {
    return firmware::load_config(file, &reader);
  });
}

Result<DriveConfig> load_recorded_drive_config(const std::filesystem::path& file,
                                               const firmware::ConfigFiles& files) {
  return load_with_simulation([&](const firmware::SimulationReader& reader) {
    return firmware::load_config_without_manifest(file, &reader, files);
  });
}

}  // namespace bevloc::evaluation
