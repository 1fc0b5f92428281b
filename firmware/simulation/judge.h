// Listens on the bus and compares bevloc's poses with the truth that only the simulator knows.
#pragma once

#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "can/bus.h"
#include "can/vehicle_input.h"
#include "common/result.h"
#include "firmware/health.h"
#include "firmware/simulation/error_statistics.h"
#include "firmware/simulation/pose_reader.h"
#include "firmware/vehicle_sample.h"
#include "pipeline/map/hd_map.h"
#include "pipeline/tracker/tracker.h"

namespace bevloc::firmware {

/// One moment of a judged drive.
struct JudgedPose {
  double time_s = 0.0;  ///< since the start of the drive
  State state = State::kInit;
  Se2 truth;
  Se2 prior;     ///< GNSS and odometry alone
  Se2 estimate;  ///< what bevloc sent
};

/// The log's times count from log_start, before the first frame; poses' from drive_start.
struct JudgeTimes {
  Time log_start;
  Time drive_start;
};

/// What a display may show of the drive so far.
struct JudgeView {
  State state = State::kInit;
  std::optional<JudgedPose> latest;
  uint64_t valid_poses = 0;
};

/// A passive node: it reads frames like any consumer, keeps the prior by a tracker of its own that
/// hears the same odometry and GNSS but no corrections, writes the bus to a candump log, and
/// compares ten times a second. One thread, but view() may be called from any.
class Judge {
 public:
  using TruthAt = std::function<Se2(double time_s)>;

  /// Fails when the log cannot be written.
  static Result<std::unique_ptr<Judge>> create(std::unique_ptr<can::Bus> bus,
                                               const can::BaseIds& base, const GeoOrigin& origin,
                                               TruthAt truth, JudgeTimes times,
                                               const std::string& log_path);

  /// Takes in what was sent, waiting `timeout` at most for something.
  void step(Duration timeout);

  JudgeView view() const;

  const std::vector<JudgedPose>& poses() const { return poses_; }
  PoseError prior_error() const { return prior_error_.summary(); }
  PoseError estimate_error() const { return estimate_error_.summary(); }
  /// When the first valid pose was sent, seconds since the start of the drive; negative if never.
  double first_fix_s() const { return first_fix_s_; }
  /// Of the poses sent since then, the share that was valid.
  double valid_share() const;
  /// Frames that the localizer sent.
  uint64_t localizer_frames() const { return localizer_frames_; }

 private:
  Judge(std::unique_ptr<can::Bus> bus, const can::BaseIds& base, const GeoOrigin& origin,
        TruthAt truth, JudgeTimes times);

  void take(const can::ReceivedFrame& received);
  void note_solution(const can::ReceivedFrame& received, bool valid);
  void compare(const BusPose& pose);

  std::unique_ptr<can::Bus> bus_;
  can::BaseIds base_;
  TruthAt truth_;
  JudgeTimes times_;
  std::ofstream log_;
  PoseReader reader_;
  can::VehicleInput prior_input_;
  Tracker prior_tracker_;
  Time next_comparison_;
  std::vector<JudgedPose> poses_;
  ErrorStatistics prior_error_;
  ErrorStatistics estimate_error_;
  uint64_t localizer_frames_ = 0;
  uint64_t solutions_since_fix_ = 0;
  double first_fix_s_ = -1.0;
  mutable std::mutex view_mutex_;
  JudgeView view_;
};

}  // namespace bevloc::firmware
