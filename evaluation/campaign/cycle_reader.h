// Reads what the localizer sends in every bus cycle and compares each pose with the truth.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "can/bus/bus.h"
#include "can/messages/message_table.h"
#include "evaluation/drive/pose_reader.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {

/// A valid pose, along the axes of the true vehicle: longitudinal m, lateral m, yaw rad.
struct JudgedError {
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();       ///< as sent; not finite if it was SNA
  Eigen::Vector3d protection = Eigen::Vector3d::Zero();  ///< protection level; likewise
};

/// One bus cycle of the localizer.
struct JudgedCycle {
  double time_s = 0.0;  ///< of the drive
  HealthState state = HealthState::kInit;
  WhyMask why;
  /// Empty if no valid pose was sent. Of several poses, the one whose error is the largest part of
  /// an alert limit.
  std::optional<JudgedError> pose;
};

inline constexpr Duration kSolutionCycle = std::chrono::milliseconds(can::kSolutionCycleMs);

/// The times of the bus cycles that are missing between two cycles, because the appliance was
/// silent. Empty if the second cycle follows the first at once. All times are seconds of the drive.
std::vector<double> missing_cycles_s(double before_s, double now_s);

/// A passive node on the bus. Unlike Judge, it takes every pose (100 per second), and does nothing
/// else. One thread.
class CycleReader {
 public:
  using TruthAt = std::function<Se2(double time_s)>;

  CycleReader(std::unique_ptr<can::Bus> bus, const can::BaseIds& base, const GeoOrigin& origin,
              TruthAt truth, Time drive_start);

  /// Takes all received frames. Call it after each cycle of the localizer.
  JudgedCycle step(Time now);

 private:
  void take_deviation(const can::Frame& frame);
  JudgedError judge(const BusPose& pose) const;

  std::unique_ptr<can::Bus> bus_;
  can::BaseIds base_;
  TruthAt truth_;
  Time drive_start_;
  PoseReader reader_;
  Eigen::Vector3d sigma_;  ///< of the latest LOC_StdDev
};

}  // namespace bevloc::evaluation
