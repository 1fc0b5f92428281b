// Keeps the condition of a CAN controller by its error reports.
#pragma once

#include <atomic>

#include "can/bus_condition.h"
#include "can/error_frame.h"

namespace bevloc::can {

/// One thread reports; reset() and condition() are for any.
class ControllerMonitor {
 public:
  void take(const ErrorFrame& error);

  /// A frame went over the bus, whoever sent it: so there is another node, and we are not off. The
  /// error counters may still be high.
  void note_traffic();

  /// The interface is down: when it comes up, its controller starts anew and says nothing.
  void reset() { condition_ = BusCondition{}; }

  BusCondition condition() const { return condition_; }

 private:
  std::atomic<BusCondition> condition_{BusCondition{}};
};

}  // namespace bevloc::can
