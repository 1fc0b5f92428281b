// Compares the poses on the bus with the truth, which only the simulator knows.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "can/bus/bus.h"
#include "can/messages/vehicle_decoder.h"
#include "common/result.h"
#include "evaluation/drive/bus_log.h"
#include "evaluation/drive/error_statistics.h"
#include "evaluation/drive/pose_reader.h"
#include "firmware/config/config.h"
#include "firmware/health/health.h"
#include "pipeline/map/hd_map.h"
#include "pipeline/tracker/tracker.h"

namespace bevloc::evaluation {

/// One comparison of a drive.
struct JudgedPose {
  double time_s = 0.0;  ///< since the start of the drive
  HealthState state = HealthState::kInit;
  Se2 truth;
  Se2 prior;     ///< GNSS and odometry alone
  Se2 estimate;  ///< sent by bevloc
};

/// Times in the bus log count from log_start, times of poses from drive_start.
struct JudgeTimes {
  Time log_start;
  Time drive_start;
};

/// The state of the drive so far, for a display.
struct JudgeView {
  HealthState state = HealthState::kInit;
  std::optional<JudgedPose> latest;
  uint64_t valid_poses = 0;
};

/// A passive node on the bus. It reads the poses like any consumer and compares them with the truth
/// ten times a second. Its own tracker gets the same odometry and GNSS but no corrections, and so
/// provides the prior. It writes all frames to a candump log. One thread; note_gap() and view() may
/// be called from any thread.
class Judge {
 public:
  using TruthAt = std::function<Se2(double time_s)>;

  /// `truth` must be callable as long as the judge exists. Fails if the log cannot be written.
  static Result<std::unique_ptr<Judge>> create(std::unique_ptr<can::Bus> bus,
                                               const firmware::CanConfig& can,
                                               const GeoOrigin& origin, TruthAt truth,
                                               JudgeTimes times, const std::string& log_path);

  /// Reads all received frames. Waits at most `timeout` for the first one.
  void step(Duration timeout);

  /// Tells of a gap of the clock or a suspension that ends at `end`, during which the vehicle
  /// drives on. The prior begins anew with the first frame after it.
  void note_gap(Time end) { gap_end_ = end; }

  /// Completes the log. Call it after the last step(). Fails if the log lacks a frame.
  Status finish() { return log_.finish(); }

  JudgeView view() const;

  const std::vector<JudgedPose>& poses() const { return poses_; }
  PoseError prior_error() const { return prior_error_.summary(); }
  PoseError estimate_error() const { return estimate_error_.summary(); }
  /// The time of the first valid pose since the start of the drive; negative if there was none.
  double first_fix_s() const { return first_fix_s_; }
  /// The share of the cycles since the first fix that have sent a valid pose.
  double valid_share() const;
  /// Number of CAN frames that the localizer sent.
  uint64_t localizer_frames() const { return localizer_frames_; }

 private:
  static constexpr Time kNoGap = Time::max();

  /// GNSS and odometry alone.
  struct Prior {
    explicit Prior(std::unique_ptr<can::VehicleDecoder> decoder) : input(std::move(decoder)) {}

    std::unique_ptr<can::VehicleDecoder> input;
    Tracker tracker{TrackerParameters()};
  };

  Judge(std::unique_ptr<can::Bus> bus, const firmware::CanConfig& can, const GeoOrigin& origin,
        TruthAt truth, JudgeTimes times, BusLog log);

  Prior new_prior() const;
  void take(const can::ReceivedFrame& received);
  void note_solution(const can::ReceivedFrame& received, bool valid);
  void compare(const BusPose& pose);

  std::unique_ptr<can::Bus> bus_;
  firmware::CanConfig can_;
  can::GeodeticPosition map_origin_;
  TruthAt truth_;
  JudgeTimes times_;
  BusLog log_;
  PoseReader reader_;
  Prior prior_;
  /// The end of a gap that no frame has followed yet; otherwise kNoGap.
  std::atomic<Time> gap_end_{kNoGap};
  Time next_comparison_;
  std::vector<JudgedPose> poses_;
  ErrorStatistics prior_error_;
  ErrorStatistics estimate_error_;
  uint64_t localizer_frames_ = 0;
  uint64_t solutions_since_fix_ = 0;
  double latest_s_ = 0.0;  ///< when a frame of any node was received
  double first_fix_s_ = -1.0;
  mutable std::mutex view_mutex_;
  JudgeView view_;
};

}  // namespace bevloc::evaluation
