// Reads the configuration of a program with the simulator: the appliance's, and the drive's.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/cameras.h"
#include "drivers/mock/true_rig.h"
#include "firmware/config/config.h"
#include "sim/faults/fault.h"
#include "sim/render/renderer.h"
#include "sim/vehicle/drive.h"

namespace bevloc::evaluation {

// Limits of the length of a drive.
inline constexpr double kShortestDrive_s = 0.1;
inline constexpr double kLongestDrive_s = 1e6;

/// How the street of a drive differs from the simulator's own, as in training.
struct StreetConfig {
  std::optional<uint64_t> seed;  ///< of the looks; empty: the drive's
  double looks = 0.0;            ///< factor on the ranges of sim::street_looks()
  double slopes = 0.0;           ///< factor on the curvatures of the evaluation set "slopes"
  std::filesystem::path photos;  ///< folder of script/photos; empty: the simulator's own textures
};

/// The drive that the mock cameras see: the section `simulation` and the map's `procedural_seed`.
struct SimulationConfig {
  uint64_t seed = 1;
  double duration_s = 60.0;
  sim::StopTimes stops;
  sim::Pace pace;
  std::optional<uint64_t> town_seed;  ///< of a procedural town; empty if the map is a file
  sim::Conditions conditions;
  drivers::CalibrationError calibration_error;  ///< 1 sigma
  StreetConfig street;
  std::vector<sim::Fault> faults;
  /// Where `bevloc fault` can reach the running drive; empty: nowhere.
  std::filesystem::path fault_socket;
  /// Delay of each camera's exposure after the common tick.
  std::array<Duration, kCameraCount> exposure_offsets{};
};

/// The appliance's configuration, and that of the drive if the cameras are mocks.
struct DriveConfig : firmware::Config {
  std::optional<SimulationConfig> simulation;
};

/// A reader of what only a program with the simulator reads. It fills `simulation`, which must
/// outlive the reader. After read_simulation(), `simulation` has a value.
firmware::SimulationReader simulation_reader(std::optional<SimulationConfig>& simulation);

/// Like firmware::load_config(), but accepts mock cameras.
Result<DriveConfig> load_drive_config(const std::filesystem::path& file);

/// Like firmware::load_config_without_manifest(), but accepts mock cameras.
Result<DriveConfig> load_recorded_drive_config(const std::filesystem::path& file,
                                               const firmware::ConfigFiles& files);

}  // namespace bevloc::evaluation
