// Derives the condition of a CAN controller from its error reports.
#pragma once

#include <atomic>

#include "can/bus/bus_condition.h"
#include "can/bus/error_frame.h"

namespace bevloc::can {

/// Whether the controller reports that received frames were lost because the driver did not fetch
/// them in time.
bool says_frames_lost(const ErrorFrame& error);

/// Thread-bound: take() and note_traffic() are called from the receiving thread of the bus. reset()
/// and condition() are thread-safe.
class ControllerMonitor {
 public:
  void take(const ErrorFrame& error);

  /// Call it when a frame of any node arrived. It shows that our controller is not bus-off, and
  /// clears the faults. A warning or passive state stays, because the error counters may still be
  /// high. Returns whether the controller was bus-off, and thus has restarted without a report.
  bool note_traffic();

  /// Call it when the controller is already bus-off at the start, because no report says so.
  void note_bus_off() { condition_ = BusCondition{.state = BusState::kOff}; }

  /// Call it when the interface is down: its controller restarts without an error report.
  void reset() { condition_ = BusCondition{}; }

  BusCondition condition() const { return condition_; }

 private:
  std::atomic<BusCondition> condition_{BusCondition{}};
};

}  // namespace bevloc::can
