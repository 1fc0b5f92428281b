#include "evaluation/drive/clock_faults.h"

#include <algorithm>

#include "sim/faults/drive_clock.h"

namespace bevloc::evaluation {

Duration ClockFaults::gap_due(double elapsed_s) {
  double gap_s = 0.0;
  for (const sim::Fault& fault : faults_->active(sim::FaultInput::kClock, elapsed_s)) {
    if (fault.kind != sim::FaultKind::kClockGap || fault.from_s < jumped_until_s_) continue;
    jumped_until_s_ = fault.from_s + fault.amounts.gap_s;
    gap_s = std::max(gap_s, jumped_until_s_ - elapsed_s);
  }
  return from_seconds(gap_s);
}

Duration ClockFaults::suspension_due(double elapsed_s) {
  const double total_s =
      sim::drive_time_s(elapsed_s, faults_->all(sim::FaultInput::kClock)) - elapsed_s;
  const double new_s = std::max(0.0, total_s - suspended_s_);
  suspended_s_ = std::max(suspended_s_, total_s);
  return from_seconds(new_s);
}

}  // namespace bevloc::evaluation
