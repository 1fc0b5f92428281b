// What one run of the campaign shows: detection, poses beyond the alert limits, how often errors
// are within the sigmas, and recovery.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "evaluation/campaign/cycle_reader.h"
#include "evaluation/campaign/modes/fault_time.h"
#include "evaluation/campaign/protection_counts.h"

namespace bevloc::evaluation {

/// A change of the state or of the reasons.
struct TimelineEntry {
  double time_s = 0.0;
  HealthState state = HealthState::kInit;
  WhyMask why;
};

struct RunOutcome {
  /// Since the first valid pose. Cycles of a silent appliance count, too.
  uint64_t cycles = 0;
  uint64_t valid = 0;                               ///< cycles with a valid pose
  uint64_t beyond_alert = 0;                        ///< valid poses beyond an alert limit
  Eigen::Vector3d worst = Eigen::Vector3d::Zero();  ///< largest absolute errors of valid poses
  std::array<PoseCounts, 3> within_sigma{};         ///< [k]: errors within k + 1 sigmas
  ProtectionCounts protection;
  int false_lost = 0;                 ///< how often a valid pose was lost before the fault
  int lost = 0;                       ///< how often in all
  double first_fix_s = -1.0;          ///< the first valid pose; negative if there was none
  std::string detected_by;            ///< why bits, "not valid" or "never valid"; or empty
  std::optional<double> detection_s;  ///< since the start of the fault; empty if "never valid"
  std::optional<double> recovery_s;   ///< since the end of the fault
  std::vector<TimelineEntry> timeline;

  double valid_share() const;
  double beyond_alert_s() const;
};

/// Judges a run cycle by cycle. One thread.
class RunJudge {
 public:
  /// `named_by`: the why bits that name this fault. The fault counts as detected when one of them
  /// is set that was not set when the fault began, or when a pose that was valid is not any more.
  RunJudge(const FaultTime& fault, WhyMask named_by);

  /// Takes the cycles in the order of their times. In the cycles that are missing between two of
  /// them, there was no valid pose.
  void add(const JudgedCycle& cycle);

  /// The outcome of the run. Call it after the last cycle.
  RunOutcome outcome() const;

 private:
  void take(const JudgedCycle& cycle);
  void note_state(const JudgedCycle& cycle);
  void note_pose(const JudgedCycle& cycle);
  void note_detection(const JudgedCycle& cycle);
  void note_recovery(const JudgedCycle& cycle);

  FaultTime fault_;
  WhyMask named_by_;
  RunOutcome outcome_;
  WhyMask why_before_;  ///< why bits that have been set since before the fault
  std::optional<JudgedCycle> latest_;
  bool was_valid_ = false;
  std::optional<double> good_since_s_;  ///< since when, after the fault, the pose has been right
};

/// The names of the why bits as in the CAN message, without "Why_"; joined with "+".
std::string names_of(WhyMask why);

}  // namespace bevloc::evaluation
