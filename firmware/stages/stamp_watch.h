// Watches whether the time stamps of the cameras fit the motion of the vehicle.
#pragma once

#include <cstdint>

#include "common/time.h"
#include "firmware/stages/messages.h"
#include "pipeline/localization/stamp_monitor.h"

namespace bevloc::firmware {

/// Combines two sources: vision reports that the stamps jumped, and StampMonitor compares the
/// headings of matches with the yaw rate. Stamps that jumped count as wrong until they jump back or
/// bends show that they are right. If bends showed this, the stamps from before the jump were
/// wrong, so a jump back makes them wrong again. Stamps that were wrong before a jump are still
/// wrong after a jump back. Allocates in the constructor only. One thread.
class StampWatch {
 public:
  /// Adds the vehicle's yaw rate.
  void add_rate(Time time, double yaw_rate_radps) { monitor_.add_rate(time, yaw_rate_radps); }

  /// Adds what vision reports about a frameset.
  void add_report(const VisionReport& report);

  /// Whether the stamps are wrong, or jumped and no bend has confirmed them since.
  bool contradicts() const { return monitor_.contradicts() || jumped_; }

  /// Offset of the stamps against odometry; 0 while it is tolerated.
  int offset_ms() const { return monitor_.contradicting_ms(); }

  /// Begins a new history after a gap in time. Wrong stamps stay wrong.
  void note_gap();

 private:
  void note_jump(const VisionReport& report);
  void note_jump_back();
  void compare_heading(const VisionReport& report);

  /// Tolerates 30 ms, because the yaw rate of a sensor is itself late by some 10 ms.
  StampMonitor monitor_{std::chrono::milliseconds(30)};
  bool latest_jumped_ = false;  ///< what the latest report says
  uint64_t jumps_ = 0;          ///< VisionReport::stamp_jumps so far
  bool jumped_ = false;         ///< the stamps jumped, and no bend has confirmed them since
  /// While vision reports a jump: whether the stamps are wrong when they jump back.
  bool wrong_before_ = false;
};

}  // namespace bevloc::firmware
