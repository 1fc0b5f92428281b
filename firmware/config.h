// The configuration file of bevlocd.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "can/message.h"
#include "common/result.h"
#include "drivers/camera/mock_schedule.h"
#include "drivers/camera/true_rig.h"
#include "drivers/frameset/synchronizer.h"
#include "firmware/camera_devices_config.h"
#include "firmware/gpio_config.h"
#include "firmware/health.h"
#include "firmware/realtime_config.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/solver/solver_factory.h"
#include "pipeline/tracker/tracker.h"
#include "sim/render/renderer.h"

namespace bevloc::firmware {

enum class CameraDriver : uint8_t { kMock, kReplay, kV4l2, kLibcamera };
enum class CanDriver : uint8_t { kMock, kSocketCan };
enum class LogLevel : uint8_t { kDebug, kInfo, kWarning, kError };

struct CameraConfig {
  CameraDriver driver = CameraDriver::kMock;
  int buffers = 6;  ///< per camera
  drivers::SynchronizerConfig synchronizer;
  bool compensate_motion = true;    ///< between the exposures of one set
  double rate_hz = 10.0;            ///< of mock cameras
  std::filesystem::path recording;  ///< of replay cameras: holds a folder for each of kCameraNames
  CameraDevicesConfig devices;      ///< of V4L2 and libcamera cameras
};

/// The map comes from a file or, for mock cameras, from the seed of a made-up town.
struct MapConfig {
  std::filesystem::path file;  ///< empty when procedural
  std::optional<uint64_t> procedural_seed;
};

struct SolverConfig {
  SolverKind kind = SolverKind::kBandedRefined;
  HypothesisGrid tracking;
  HypothesisGrid acquiring{{6.0, 0.2}, {4.0, 0.2}, {radians(4.0), radians(0.2)}};
};

struct CanConfig {
  CanDriver driver = CanDriver::kMock;
  std::string interface;                                  ///< of SocketCAN
  can::FrameFormat variant = can::FrameFormat::kClassic;  ///< of the messages that bevloc sends
  can::BaseIds base_ids;
};

/// The drive that mock cameras see.
struct SimulationConfig {
  uint64_t seed = 1;
  double duration_s = 60.0;
  sim::Conditions conditions;
  drivers::CalibrationError calibration_error;  ///< 1 sigma
  std::array<std::vector<drivers::CameraFault>, kCameraCount> camera_faults;
  /// How much later than the beat of `rate_hz` each camera exposes, always.
  std::array<Duration, kCameraCount> exposure_offsets{};
};

struct Config {
  CameraConfig cameras;
  std::filesystem::path rig_file;
  MapConfig map;
  std::filesystem::path model_file;
  SolverConfig solver;
  CanConfig can;
  TrackerParameters tracker;
  HealthLimits health;
  GpioConfig gpio;
  RealtimeConfig realtime;
  LogLevel log_level = LogLevel::kInfo;
  std::optional<SimulationConfig> simulation;  ///< there with mock cameras, and only then
};

/// Reads a configuration file; docs/configuration.md describes each key. Every key must be known,
/// there once, of the right type and in range; else the error names file, line and key. Paths in
/// the file are relative to its folder; those in the result are ready to open.
Result<Config> load_config(const std::filesystem::path& file);

/// Reads all that the configuration names: rig, map, model, recordings and camera devices. What
/// bevlocd
/// --check-config does.
Status check_config(const Config& config);

}  // namespace bevloc::firmware
