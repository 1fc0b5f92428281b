// Reads the configuration file of bevlocd.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "can/messages/message.h"
#include "can/vehicle/vehicle_binding.h"
#include "common/result.h"
#include "common/strict_yaml.h"
#include "drivers/frameset/synchronizer.h"
#include "firmware/config/camera_devices_config.h"
#include "firmware/config/clock_config.h"
#include "firmware/config/gnss_config.h"
#include "firmware/config/gpio_config.h"
#include "firmware/config/kept_files.h"
#include "firmware/config/live_config.h"
#include "firmware/config/realtime_config.h"
#include "firmware/config/record_config.h"
#include "firmware/health/health.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/localization/localizer.h"
#include "pipeline/solver/solver_factory.h"
#include "pipeline/tracker/tracker.h"

namespace bevloc::firmware {

enum class CameraDriver : uint8_t { kMock, kReplay, kV4l2, kLibcamera };
enum class CanDriver : uint8_t { kMock, kSocketCan };
enum class LogLevel : uint8_t { kDebug, kInfo, kWarning, kError };

struct CameraConfig {
  CameraDriver driver = CameraDriver::kMock;
  int buffers = 6;  ///< per camera
  drivers::SynchronizerConfig synchronizer;
  /// Whether to compensate motion between the exposures of one frameset.
  bool compensate_motion = true;
  double rate_hz = 10.0;            ///< for mock cameras only
  std::filesystem::path recording;  ///< for replay only: has one folder for each of kCameraNames
  CameraDevicesConfig devices;      ///< for V4L2 and libcamera only
};

struct SolverConfig {
  SolverKind kind = LocalizerOptions().solver;
  HypothesisGrid tracking = LocalizerOptions().tracking;
  HypothesisGrid acquiring = LocalizerOptions().acquiring;

  bool operator==(const SolverConfig&) const = default;
};

/// Authentication of the messages (SecOC).
struct SecocConfig {
  std::filesystem::path key_file;
  std::filesystem::path starts_file;  ///< counts the starts, for the freshness value
};

struct CanConfig {
  CanDriver driver = CanDriver::kMock;
  std::string interface;                                  ///< for SocketCAN only
  can::FrameFormat variant = can::FrameFormat::kClassic;  ///< format of the messages that are sent
  can::BaseIds base_ids;
  double rear_track_m = 1.6;  ///< distance between the rear wheels
  std::optional<SecocConfig> secoc;
  bool sends_clock = false;  ///< whether to send LOC_Clock (section `clock`)
  /// The vehicle's own messages, read in place of bevloc's VEH_ messages.
  std::optional<can::VehicleBinding> vehicle;
  std::filesystem::path dbc_file;  ///< the DBC file of `vehicle`
};

/// Reads the parts of a configuration that only a program with the simulator supports. It is used
/// only with `cameras.driver: mock`.
struct SimulationReader {
  /// Reads `procedural_seed` from the section `map`. Returns false if the section has no such key;
  /// load_config() then reads the map file.
  std::function<bool(YamlMap& map)> read_procedural_map;
  /// Reads the section `simulation`.
  std::function<void(YamlMap simulation)> read_simulation;
};

struct Config {
  std::filesystem::path file;  ///< this configuration
  CameraConfig cameras;
  std::filesystem::path rig_file;
  OnlineCalibrationOptions online_calibration;
  std::filesystem::path learned_calibration_file;  ///< empty if nothing is kept across restarts
  std::filesystem::path map_file;                  ///< empty for a procedural town
  std::filesystem::path model_file;
  std::filesystem::path manifest_file;  ///< empty if no checksums are compared
  /// This configuration, the rig, the DBC file and the manifest as load_config() has read them.
  KeptFiles kept_files;
  SolverConfig solver;
  CanConfig can;
  std::optional<GnssConfig> gnss;  ///< empty if GNSS comes on the CAN bus
  TrackerParameters tracker;
  HealthLimits health;
  GpioConfig gpio;
  RealtimeConfig realtime;
  std::optional<RecordConfig> record;  ///< empty if nothing is recorded
  ClockConfig clock;
  LogLevel log_level = LogLevel::kInfo;
  std::optional<LiveConfig> live;  ///< empty if there is no server
};

/// Where a configuration finds the files that it names.
struct ConfigFiles {
  std::filesystem::path folder;    ///< the folder where relative paths begin
  std::filesystem::path dbc_file;  ///< used in place of `can.vehicle.dbc` if not empty
};

/// Reads a configuration file; docs/configuration.md describes each key. Every key must be known,
/// present once, of the right type and in range. Otherwise the error names file, line and key.
/// Paths in the file are relative to its folder, and paths in the result can be opened as they are.
/// Refuses mock cameras if `simulation` is null. If the file names a manifest, checks it
/// (manifest.h), so that the result names only files with the right checksums.
Result<Config> load_config(const std::filesystem::path& file,
                           const SimulationReader* simulation = nullptr);

/// Like load_config(), but finds the files in `files` and does not check the manifest. This is for
/// the configuration of a recording, whose files may have changed since it was made.
Result<Config> load_config_without_manifest(const std::filesystem::path& file,
                                            const SimulationReader* simulation,
                                            const ConfigFiles& files);

/// Reads the keys of a configuration; load_config() finishes it. The schema of the configuration is
/// made from this function (command/schema).
Config read_config(YamlMap& yaml, const ConfigFiles& files, const SimulationReader* simulation);

}  // namespace bevloc::firmware
