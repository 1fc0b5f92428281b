// What a report shows, read from a recording.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/health_state.h"
#include "evaluation/recording/recording.h"
#include "evaluation/recording/track.h"

namespace bevloc::evaluation {

/// A time in which state and reasons did not change. Seconds since the beginning of the report.
struct StatePeriod {
  double begin_s = 0.0;
  double end_s = 0.0;
  HealthState state = HealthState::kInit;
  WhyMask why;
};

/// One recorded cycle with a pose.
struct PosedCycle {
  double time_s = 0.0;
  HealthState state = HealthState::kInit;
  Se2 map_from_vehicle;
  double sigma_m = 0.0;  ///< of the position along its worst axis
  double protection_longitudinal_m = 0.0;
  double protection_lateral_m = 0.0;
  std::optional<Se2> error;  ///< against the truth: longitudinal, lateral, yaw
};

struct RecordedMatchResult {
  double time_s = 0.0;
  Time frame_time;
  bool evidence = false;
  double score = 0.0;
  Se2 correction;
  std::array<double, 3> sigma{};  ///< longitudinal m, lateral m, yaw rad
  unsigned cameras = 0;
};

struct TimedValue {
  double time_s = 0.0;
  double value = 0.0;
};

struct ReportData {
  uint64_t begin_ns = 0;  ///< log time of second 0
  double length_s = 0.0;
  std::vector<StatePeriod> periods;
  std::vector<PosedCycle> cycles;  ///< at most ten a second
  std::vector<RecordedMatchResult> matches;
  std::vector<TimedValue> latency_ms;  ///< from exposure to the first pose that uses the frameset
  Track truth;
  std::vector<double> bus_in_s;  ///< when frames came in
  std::array<std::vector<double>, kCameraCount> images_s;
  std::optional<bevloc::recording::Counters> counters;  ///< the last ones
  std::optional<HdMap> map;
};

Result<ReportData> read_report_data(Recording& recording);

/// Local time of day, such as 14:32:05.3.
std::string time_of_day(const ReportData& data, double time_s);

/// Reads "14:32", "14:32:05" (local time of day) or "12.5" (seconds since the beginning). A time
/// without seconds means the first LOST or FAULT in that minute, or else the start of the minute. A
/// time before the first state means the begin of this state.
/// Fails for a time outside of the recording.
Result<double> parse_moment(const ReportData& data, const std::string& text);

/// What the recording tells of the state at this moment, one sentence each: the state, its reasons,
/// what came before, and what the inputs did in the five seconds until the state began.
std::vector<std::string> explain(const ReportData& data, double time_s);

}  // namespace bevloc::evaluation
