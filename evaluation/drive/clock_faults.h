// When the simulated appliance stands still or is suspended.
#pragma once

#include <memory>
#include <utility>

#include "common/time.h"
#include "sim/faults/fault_board.h"

namespace bevloc::evaluation {

/// Tells once for each clock fault how far to move the appliance's clock. gap_due() and
/// suspension_due() may be called from different threads.
class ClockFaults {
 public:
  explicit ClockFaults(std::shared_ptr<const sim::FaultBoard> faults)
      : faults_(std::move(faults)) {}

  /// How far the clock must jump ahead now, because the appliance stands still. Call it repeatedly.
  /// A fault that began and ended between two calls counts in the second one. `elapsed_s`: the time
  /// since the drive's start.
  Duration gap_due(double elapsed_s);

  /// For how long the machine was suspended since the previous call. Call it before the vehicle
  /// sends.
  Duration suspension_due(double elapsed_s);

 private:
  std::shared_ptr<const sim::FaultBoard> faults_;
  double jumped_until_s_ = 0.0;
  double suspended_s_ = 0.0;
};

}  // namespace bevloc::evaluation
