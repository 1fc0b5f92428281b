// Derives the condition of a CAN controller from its error reports.
#pragma once

#include <atomic>

#include "can/bus/bus_condition.h"
#include "can/bus/error_frame.h"

namespace bevloc::can {

/// One thread calls take() and note_traffic(). Any thread may call reset() and condition().
class ControllerMonitor {
 public:
  void take(const ErrorFrame& error);

  /// To be called when any node has sent a frame: there is another node, and our controller is not
  /// bus-off. Clears the faults, but not a warning or passive state, as the error counters may
  /// still be high.
  void note_traffic();

  /// To be called when the interface is down: its controller restarts without an error report.
  void reset() { condition_ = BusCondition{}; }

  BusCondition condition() const { return condition_; }

 private:
  std::atomic<BusCondition> condition_{BusCondition{}};
};

}  // namespace bevloc::can
