// What a simulated drive came to: a table for people, JSON for programs, CSV for plots.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/result.h"
#include "firmware/appliance.h"
#include "firmware/simulation/judge.h"

namespace bevloc::firmware {

struct LatencyReport {
  double p50_ms = 0.0;
  double p99_ms = 0.0;
};

struct DriveReport {
  PoseError prior;
  PoseError estimate;
  FrameCounts frames;
  /// From start of exposure to the first CAN frame of a pose that rests on it. On a virtual clock
  /// computing takes no time, so there it is what sensor and bus cycle alone take.
  LatencyReport latency;
  int realtime_refusals = 0;  ///< see Realtime
  uint64_t can_sent = 0;
  double first_fix_s = 0.0;  ///< from the start of the drive; negative if never
  double valid_share = 0.0;  ///< of the drive after the first fix
  uint64_t seed = 0;
  double duration_s = 0.0;
  std::string map;
  std::string model;
  std::vector<JudgedPose> poses;
};

std::string to_table(const DriveReport& report);
std::string to_json(const DriveReport& report);

/// One line per judged moment: time, state, truth, prior, estimate.
Status write_csv(const DriveReport& report, const std::string& path);

}  // namespace bevloc::firmware
