// The result of a simulated drive, as a table, JSON and CSV.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/result.h"
#include "evaluation/drive/judge.h"
#include "firmware/runtime/appliance.h"

namespace bevloc::evaluation {

struct LatencyReport {
  double p50_ms = 0.0;
  double p99_ms = 0.0;
};

struct DriveReport {
  PoseError prior;
  PoseError estimate;
  firmware::FrameCounts frames;
  /// The time from the start of exposure to the first CAN frame of a pose that uses the frameset.
  /// On a virtual clock, computing takes no time, so only sensor and bus cycle contribute.
  LatencyReport latency;
  int realtime_refusals = 0;  ///< firmware::Realtime::refusals()
  uint64_t can_sent = 0;
  double first_fix_s = 0.0;  ///< since the start of the drive; negative if there was none
  double valid_share = 0.0;  ///< Judge::valid_share()
  uint64_t seed = 0;
  double duration_s = 0.0;  ///< as configured
  double driven_s = 0.0;    ///< less than duration_s if the drive was stopped before its end
  std::string map;
  std::string model;
  std::vector<JudgedPose> poses;
};

std::string to_table(const DriveReport& report);
/// `prior` and `estimate` are null if no pose was valid.
std::string to_json(const DriveReport& report);

/// Writes one line per judged pose: time, state, truth, prior, estimate. Fails if the file cannot
/// be written.
Status write_csv(const DriveReport& report, const std::string& path);

}  // namespace bevloc::evaluation
