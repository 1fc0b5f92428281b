#include "firmware/config/config.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/ranges.h>

#include "firmware/config/config_milliseconds.h"
#include "firmware/config/files_of_config.h"
#include "firmware/config/manifest.h"
#include "firmware/config/vehicle_bus_config.h"

namespace bevloc::firmware {
namespace {

std::filesystem::path path_of(YamlMap& yaml, std::string_view key,
                              const std::filesystem::path& folder) {
  return folder / yaml.require<std::string>(key, not_empty("the name of a file"));
}

CameraConfig read_cameras(YamlMap yaml, const std::filesystem::path& folder) {
  CameraConfig cameras;
  cameras.driver =
      yaml.require_choice<CameraDriver>("driver", {{"mock", CameraDriver::kMock},
                                                   {"replay", CameraDriver::kReplay},
                                                   {"v4l2", CameraDriver::kV4l2},
                                                   {"libcamera", CameraDriver::kLibcamera}});
  switch (cameras.driver) {
    case CameraDriver::kMock:
      cameras.rate_hz = yaml.require<double>("rate_hz", between(1.0, 60.0));
      break;
    case CameraDriver::kReplay:
      cameras.recording = path_of(yaml, "recording", folder);
      break;
    case CameraDriver::kV4l2:
    case CameraDriver::kLibcamera:
      cameras.devices = read_camera_devices(yaml);
      break;
  }
  cameras.buffers = yaml.optional<int>("buffers", cameras.buffers, between(2, 64));
  drivers::SynchronizerConfig& synchronizer = cameras.synchronizer;
  synchronizer.tolerance =
      optional_milliseconds(yaml, "tolerance_ms", synchronizer.tolerance, between(0.0, 50.0));
  synchronizer.wait =
      optional_milliseconds(yaml, "wait_ms", synchronizer.wait, between(1.0, 1000.0));
  synchronizer.min_cameras =
      yaml.optional<int>("min_cameras", synchronizer.min_cameras, between(1, kCameraCount));
  cameras.compensate_motion = yaml.optional<bool>("compensate_motion", cameras.compensate_motion);
  if (synchronizer.wait < synchronizer.tolerance) {
    yaml.reject("wait_ms", "less than tolerance_ms", "at least tolerance_ms");
  }
  return cameras;
}

/// Checks the rate of the cameras against the rate of their trigger, and the tolerance against
/// both.
void check_rates(YamlMap& yaml, const CameraConfig& cameras, const GpioConfig& gpio) {
  const double camera_hz =
      cameras.driver == CameraDriver::kMock ? cameras.rate_hz : cameras.devices.rate_hz;
  const double trigger_hz = gpio.trigger ? 1.0 / to_seconds(gpio.trigger->timing.period) : 0.0;
  if (camera_hz > 0.0 && camera_hz < (1.0 - 1e-6) * trigger_hz) {
    yaml.reject("rate_hz",
                fmt::format("{:.6g} beside {:.6g} in gpio.trigger.rate_hz", camera_hz, trigger_hz),
                "no key, because the trigger sets the rate, or at least the rate of the trigger");
  }
  if (to_seconds(cameras.synchronizer.tolerance) * std::max(camera_hz, trigger_hz) >= 1.0) {
    yaml.reject("tolerance_ms", "a frame period or more, so each second frame would be too late",
                "less than a frame period");
  }
}

/// Reads the path of the map file. Returns an empty path for a procedural town.
std::filesystem::path read_map(YamlMap yaml, CameraDriver camera_driver,
                               const std::filesystem::path& folder,
                               const SimulationReader* simulation) {
  if (camera_driver != CameraDriver::kMock && yaml.has("procedural_seed")) {
    yaml.require<uint64_t>("procedural_seed");
    yaml.reject_key("procedural_seed", "a procedural map with cameras that are not mocks",
                    "`file`");
  }
  const bool procedural = camera_driver == CameraDriver::kMock && simulation != nullptr &&
                          simulation->read_procedural_map(yaml);
  return procedural ? std::filesystem::path() : path_of(yaml, "file", folder);
}

/// The minimum number of steps from zero to the end of an axis. With fewer, a match hardly ever has
/// evidence.
constexpr double kLeastSteps = 4.0;

/// Reads range and step of one axis, in the unit of the file.
HypothesisAxis read_axis(YamlMap& yaml, std::string_view range_key, std::string_view step_key,
                         const HypothesisAxis& fallback, double max_range) {
  HypothesisAxis axis;
  axis.range = yaml.optional<double>(range_key, fallback.range, between(0.1, max_range));
  axis.step = yaml.optional<double>(step_key, fallback.step, between(0.01, 5.0));
  if (kLeastSteps * axis.step > axis.range * (1.0 + 1e-9)) {
    yaml.reject(
        step_key, "more than a quarter of the range",
        "at most a quarter, because of few hypotheses the best one is always at the border");
  }
  return axis;
}

/// Checks the step of an axis. `axis` and `max_range` are in the unit of the solver. One unit of
/// the solver is `per_unit` units of the file.
void check_axis(YamlMap& yaml, std::string_view step_key, const HypothesisAxis& axis,
                double max_range, double per_unit) {
  // A range or a step that is wrong by itself was reported when it was read.
  if (is_sound(axis, max_range) || axis.step > axis.range || axis.range > max_range) return;
  yaml.reject(step_key,
              fmt::format("{:.6g}, with which the last of {} steps is at {:.6g}",
                          per_unit * axis.step, axis.half_count(), per_unit * axis.farthest()),
              fmt::format("at most {} steps from zero, and none beyond {:.6g}", kMaxHalfCount,
                          per_unit * max_range));
}

void check_hypotheses(YamlMap& yaml, const HypothesisGrid& grid, double max_range_m) {
  check_axis(yaml, "x_step_m", grid.x_m, max_range_m, 1.0);
  check_axis(yaml, "y_step_m", grid.y_m, max_range_m, 1.0);
  check_axis(yaml, "yaw_step_deg", grid.yaw_rad, radians(kMaxYawRange_deg), degrees(1.0));
  if (const double count = count_of(grid); count > kMaxHypotheses) {
    yaml.reject("x_step_m", fmt::format("{:.0f} hypotheses of x, y and yaw in all", count),
                fmt::format("at most {:.0f}: larger steps or smaller ranges", kMaxHypotheses));
  }
}

HypothesisGrid read_hypotheses(std::optional<YamlMap> yaml, const HypothesisGrid& fallback) {
  if (!yaml) return fallback;
  const double max_range_m = max_shift_m(kFeatureGrid);
  const HypothesisAxis yaw_deg = read_axis(
      *yaml, "yaw_range_deg", "yaw_step_deg",
      {degrees(fallback.yaw_rad.range), degrees(fallback.yaw_rad.step)}, kMaxYawRange_deg);
  const HypothesisGrid grid{read_axis(*yaml, "x_range_m", "x_step_m", fallback.x_m, max_range_m),
                            read_axis(*yaml, "y_range_m", "y_step_m", fallback.y_m, max_range_m),
                            {radians(yaw_deg.range), radians(yaw_deg.step)}};
  check_hypotheses(*yaml, grid, max_range_m);
  return grid;
}

SolverConfig read_solver(std::optional<YamlMap> yaml) {
  SolverConfig solver;
  if (!yaml) return solver;
  std::vector<std::string> names;
  for (const SolverKind kind : all_solver_kinds()) names.emplace_back(name_of(kind));
  const std::string default_name(name_of(solver.kind));
  solver.kind = solver_kind_from(yaml->optional<std::string>("kind", default_name, one_of(names)))
                    .value_or(solver.kind);
  solver.tracking = read_hypotheses(yaml->optional_map("tracking"), solver.tracking);
  solver.acquiring = read_hypotheses(yaml->optional_map("acquiring"), solver.acquiring);
  return solver;
}

std::optional<SecocConfig> read_secoc(YamlMap& can, CanDriver driver,
                                      const std::filesystem::path& folder) {
  auto yaml = can.optional_map("secoc");
  if (!yaml) return std::nullopt;
  if (driver == CanDriver::kMock) {
    can.reject_key("secoc", "authentication on a bus inside the process",
                   "no section secoc with can.driver: mock");
  }
  return SecocConfig{.key_file = path_of(*yaml, "key_file", folder),
                     .starts_file = path_of(*yaml, "starts_file", folder)};
}

/// Whether the driver is for real cameras. With real cameras and a mock bus, no pose would reach
/// the vehicle, but the status would show no fault of CAN.
bool is_real(CameraDriver driver) {
  return driver == CameraDriver::kV4l2 || driver == CameraDriver::kLibcamera;
}

/// Reads the path of the DBC file. Returns an empty path if the key is missing.
std::filesystem::path read_dbc_file(YamlMap& vehicle, const ConfigFiles& files) {
  const std::string name = read_dbc_name(vehicle);
  if (name.empty()) return {};
  return files.dbc_file.empty() ? files.folder / name : files.dbc_file;
}

CanConfig read_can(YamlMap yaml, CameraDriver camera_driver, const ConfigFiles& files) {
  CanConfig config;
  config.driver = yaml.require_choice<CanDriver>(
      "driver", {{"mock", CanDriver::kMock}, {"socketcan", CanDriver::kSocketCan}});
  if (config.driver == CanDriver::kMock && is_real(camera_driver)) {
    yaml.reject_word("driver", "mock beside real cameras",
                     "socketcan, so that poses reach the vehicle");
  }
  if (config.driver == CanDriver::kSocketCan) {
    // IFNAMSIZ limits the length.
    config.interface = yaml.require<std::string>(
        "interface", not_empty("the name of a network interface, 1 to 15 characters", 15));
  }
  config.variant = yaml.optional_choice<can::FrameFormat>(
      "variant", config.variant,
      {{"classic", can::FrameFormat::kClassic}, {"fd", can::FrameFormat::kFd}});
  const auto base_id = between(can::BaseIds::kFirst, can::BaseIds::kLast);
  can::BaseIds& base = config.base_ids;
  base.localizer = yaml.optional<uint32_t>("localizer_base_id", base.localizer, base_id);
  base.vehicle = yaml.optional<uint32_t>("vehicle_base_id", base.vehicle, base_id);
  if (!base.are_apart()) {
    yaml.reject("localizer_base_id", "less than 0x40 apart from vehicle_base_id",
                "at least 0x40, so that messages do not share identifiers");
  }
  config.secoc = read_secoc(yaml, config.driver, files.folder);
  if (auto vehicle = yaml.optional_map("vehicle")) {
    config.dbc_file = read_dbc_file(*vehicle, files);
    config.vehicle = read_vehicle_bus(*vehicle, config.base_ids, config.dbc_file);
    if (config.secoc) {
      yaml.reject("vehicle", "the vehicle's own messages, which bevloc cannot authenticate",
                  "no section vehicle with can.secoc");
    }
  }
  config.rear_track_m =
      yaml.optional<double>("rear_track_m", config.rear_track_m, between(0.8, 3.0));
  return config;
}

TrackerParameters read_tracker(std::optional<YamlMap> yaml) {
  TrackerParameters tracker;
  if (!yaml) return tracker;
  const auto noise = between(1e-5, 10.0);
  MotionNoise& motion = tracker.motion;
  motion.longitudinal_m_per_sqrt_m = yaml->optional<double>(
      "longitudinal_noise_m_per_sqrt_m", motion.longitudinal_m_per_sqrt_m, noise);
  motion.lateral_m_per_sqrt_m =
      yaml->optional<double>("lateral_noise_m_per_sqrt_m", motion.lateral_m_per_sqrt_m, noise);
  motion.yaw_rad_per_sqrt_s = radians(yaml->optional<double>(
      "yaw_noise_deg_per_sqrt_s", degrees(motion.yaw_rad_per_sqrt_s), noise));
  tracker.initial_speed_scale_sigma = yaml->optional<double>(
      "speed_scale_sigma", tracker.initial_speed_scale_sigma, between(1e-4, 0.5));
  tracker.initial_yaw_rate_bias_sigma_radps = radians(yaml->optional<double>(
      "yaw_rate_bias_sigma_degps", degrees(tracker.initial_yaw_rate_bias_sigma_radps), noise));
  ErrorCorrelation& correlation = tracker.correlation;
  correlation.gnss_s =
      yaml->optional<double>("gnss_correlation_s", correlation.gnss_s, between(1.0, 600.0));
  const Eigen::Vector3d& match_m = correlation.match_m;
  const auto lengths_m = yaml->optional_list<double>(
      "correction_correlation_m", {match_m.begin(), match_m.end()}, 3, between(0.0, 1000.0));
  correlation.match_m = Eigen::Map<const Eigen::Vector3d>(lengths_m.data());
  tracker.gate_squared_distance = yaml->optional<double>(
      "gate_squared_distance", tracker.gate_squared_distance, between(4.0, 50.0));
  return tracker;
}

HealthLimits read_health(std::optional<YamlMap> yaml) {
  HealthLimits limits;
  if (!yaml) return limits;
  // The bounds exclude limits that are so wide that every pose would be valid.
  const auto timeout = between(10.0, 10'000.0);
  limits.odometry_timeout = optional_milliseconds(*yaml, "odometry_timeout_ms",
                                                  limits.odometry_timeout, between(10.0, 1000.0));
  limits.gnss_timeout =
      optional_milliseconds(*yaml, "gnss_timeout_ms", limits.gnss_timeout, timeout);
  limits.correction_timeout = optional_milliseconds(
      *yaml, "degraded_after_ms", limits.correction_timeout, between(10.0, 5000.0));
  limits.lost_timeout = optional_milliseconds(*yaml, "lost_after_ms", limits.lost_timeout, timeout);
  limits.corrections_to_track =
      yaml->optional<int>("corrections_to_track", limits.corrections_to_track, between(3, 1000));
  limits.refusals_to_lose =
      yaml->optional<int>("refusals_to_lose", limits.refusals_to_lose, between(1, 100));
  // No sigma may exceed the freeway alert limit of its axis.
  limits.longitudinal_sigma_m =
      yaml->optional<double>("max_longitudinal_sigma_m", limits.longitudinal_sigma_m,
                             between(0.01, kFreewayAlertLimits.x()));
  limits.lateral_sigma_m = yaml->optional<double>("max_lateral_sigma_m", limits.lateral_sigma_m,
                                                  between(0.01, kFreewayAlertLimits.y()));
  // The limit is rounded, because its value in degrees is 1.5000000000000002.
  const double most_yaw_sigma_deg = std::round(degrees(kFreewayAlertLimits.z()) * 1e9) / 1e9;
  limits.yaw_sigma_rad = radians(yaml->optional<double>(
      "max_yaw_sigma_deg", degrees(limits.yaw_sigma_rad), between(0.01, most_yaw_sigma_deg)));
  if (limits.lost_timeout <= limits.correction_timeout) {
    yaml->reject("lost_after_ms", "not more than degraded_after_ms", "more than degraded_after_ms");
  }
  return limits;
}

LogLevel read_log_level(std::optional<YamlMap> yaml) {
  if (!yaml) return LogLevel::kInfo;
  return yaml->optional_choice<LogLevel>("level", LogLevel::kInfo,
                                         {{"debug", LogLevel::kDebug},
                                          {"info", LogLevel::kInfo},
                                          {"warning", LogLevel::kWarning},
                                          {"error", LogLevel::kError}});
}

void read_online_calibration(std::optional<YamlMap> yaml, const std::filesystem::path& folder,
                             Config& config) {
  if (!yaml) return;
  OnlineCalibrationOptions& options = config.online_calibration;
  options.enabled = yaml->optional<bool>("enabled", options.enabled);
  options.max_rotation_rad = radians(yaml->optional<double>(
      "max_rotation_deg", degrees(options.max_rotation_rad), between(0.1, 2.0)));
  options.max_translation_m =
      yaml->optional<double>("max_translation_m", options.max_translation_m, between(0.01, 0.5));
  if (yaml->has("file")) config.learned_calibration_file = path_of(*yaml, "file", folder);
}

/// Reads the section `gnss`. Rejects it if the vehicle's own bus carries GNSS, too.
std::optional<GnssConfig> read_gnss_source(YamlMap& yaml, const Config& config) {
  auto section = yaml.optional_map("gnss");
  if (!section) return std::nullopt;
  GnssConfig gnss = read_gnss(*section);
  if (config.cameras.driver == CameraDriver::kMock) {
    yaml.reject_key("gnss", "a GNSS receiver with mock cameras",
                    "no section gnss, because a simulated drive has a receiver of its own");
  }
  if (config.can.vehicle && config.can.vehicle->gnss) {
    yaml.reject("gnss", "a second source of GNSS", "can.vehicle without gnss, or no section gnss");
  }
  if (config.can.secoc && !is_loopback(gnss.gpsd.address)) {
    yaml.reject("gnss", "positions over the network, which nobody authenticates, with can.secoc",
                "gpsd on this machine");
  }
  return gnss;
}

}  // namespace

Config read_config(YamlMap& yaml, const ConfigFiles& files, const SimulationReader* simulation) {
  const std::filesystem::path& folder = files.folder;
  Config config;
  YamlMap cameras = yaml.require_map("cameras");
  config.cameras = read_cameras(cameras, folder);
  if (config.cameras.driver == CameraDriver::kMock && simulation == nullptr) {
    cameras.reject_word(
        "driver", "mock",
        "v4l2, libcamera or replay, because this bevlocd was built without the simulator");
  }
  YamlMap calibration = yaml.require_map("calibration");
  config.rig_file = path_of(calibration, "rig", folder);
  read_online_calibration(calibration.optional_map("online"), folder, config);
  config.map_file = read_map(yaml.require_map("map"), config.cameras.driver, folder, simulation);
  YamlMap model = yaml.require_map("model");
  config.model_file = path_of(model, "file", folder);
  config.solver = read_solver(yaml.optional_map("solver"));
  config.can = read_can(yaml.require_map("can"), config.cameras.driver, files);
  config.gnss = read_gnss_source(yaml, config);
  config.tracker = read_tracker(yaml.optional_map("tracker"));
  config.health = read_health(yaml.optional_map("health"));
  if (auto gpio = yaml.optional_map("gpio")) {
    config.gpio = read_gpio(*gpio);
    if (config.cameras.driver == CameraDriver::kMock) {
      yaml.reject_key("gpio", "GPIO lines with mock cameras",
                      "no section gpio, because a simulated drive has no lines");
    }
  }
  check_rates(cameras, config.cameras, config.gpio);
  config.clock = read_clock_section(yaml.optional_map("clock"));
  config.can.sends_clock = config.clock.source != can::TimeSource::kFreeRunning;
  if (config.cameras.driver == CameraDriver::kMock) {
    yaml.reject_key("clock", "the clock of this machine with mock cameras",
                    "no section clock, because a simulated drive has a clock of its own");
  }
  config.realtime = read_realtime(yaml.optional_map("realtime"));
  config.log_level = read_log_level(yaml.optional_map("log"));
  config.live = read_live(yaml.optional_map("live"));
  config.record = read_record(yaml.optional_map("record"), folder);
  if (yaml.has("manifest")) config.manifest_file = path_of(yaml, "manifest", folder);
  if (config.cameras.driver == CameraDriver::kMock && simulation != nullptr) {
    simulation->read_simulation(yaml.require_map("simulation"));
  }
  return config;
}

Result<Config> load_config_without_manifest(const std::filesystem::path& file,
                                            const SimulationReader* simulation,
                                            const ConfigFiles& files) {
  KeptFiles kept;
  kept.keep(file);
  const Result<std::string> text = kept.bytes_of(file);
  if (!text) return tl::unexpected(text.error());
  Result<YamlMap> yaml = YamlMap::parse(*text, file.string());
  if (!yaml) return tl::unexpected(yaml.error());
  Config config = read_config(*yaml, files, simulation);
  config.file = file;
  if (Status finished = yaml->finish(); !finished) return tl::unexpected(finished.error());
  for (const auto* used : {&config.rig_file, &config.can.dbc_file, &config.manifest_file}) {
    kept.keep(*used);
  }
  config.kept_files = std::move(kept);
  return config;
}

Result<Config> load_config(const std::filesystem::path& file, const SimulationReader* simulation) {
  auto config = load_config_without_manifest(file, simulation,
                                             {.folder = file.parent_path(), .dbc_file = {}});
  if (!config) return config;
  if (Status own = check_learned_file(*config); !own) return tl::unexpected(own.error());
  if (Status same = check_manifest_of(*config); !same) return tl::unexpected(same.error());
  return config;
}

}  // namespace bevloc::firmware
