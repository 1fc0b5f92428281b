// Runs the real pipeline on a recording, on a virtual clock.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/drive/error_statistics.h"
#include "evaluation/recording/played_devices.h"
#include "evaluation/recording/recording.h"
#include "firmware/config/config.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

/// What a replay needs besides its inputs.
struct ReplaySetup {
  firmware::Config config;
  Rig rig;
  HdMap map;
};

/// What the replay gets from outside: recorded, or from a candump log and picture folders.
struct ReplayInputs {
  Time begin;  ///< the virtual clock starts here
  Time end;    ///< the last frame on the bus
  std::vector<PlayedFrame> bus;
  std::vector<firmware::RecordedFix> fixes;  ///< positions of gpsd, in the order of time
  std::function<std::vector<std::unique_ptr<drivers::Camera>>(drivers::Clock& clock)> cameras;
};

/// One valid or invalid pose of the replay.
struct ReplayedPose {
  Time time;
  HealthState state = HealthState::kInit;
  std::optional<Se2> map_from_vehicle;
};

struct ReplayOutcome {
  std::vector<PlayedFrame> sent;  ///< frames of the appliance, in the order of the bus
  std::vector<ReplayedPose> poses;
  uint64_t framesets = 0;
};

/// Computing takes no virtual time, so a recording that was made in lockstep gives the same frames
/// on the bus, byte for byte. Writes the bus into the candump log `can_log`, with times since
/// `begin`.
Result<ReplayOutcome> replay(const ReplaySetup& setup, const ReplayInputs& inputs,
                             const std::filesystem::path& can_log);

/// How the frames that the replay sent compare with the recorded ones.
struct BusComparison {
  size_t recorded = 0;
  size_t replayed = 0;
  size_t equal = 0;                      ///< frames that are equal before the first difference
  std::optional<std::string> different;  ///< the first difference in words
};
BusComparison compare_bus(const std::vector<PlayedFrame>& recorded,
                          const std::vector<PlayedFrame>& replayed);
/// The comparison as `bevloc replay` prints it. `in_real_time` says that the recorded drive ran in
/// real time, so that the frames differ.
std::string bus_text(const BusComparison& bus, bool in_real_time);

}  // namespace bevloc::evaluation
