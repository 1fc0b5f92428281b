#include "evaluation/drive/clock_faults.h"

#include <algorithm>

#include "sim/faults/drive_clock.h"

namespace bevloc::evaluation {

Duration ClockFaults::gap_due(double elapsed_s) {
  const double until_s = sim::clock_gaps_end_s(elapsed_s, faults_->all(sim::FaultInput::kClock));
  if (until_s <= jumped_until_s_) return Duration::zero();
  jumped_until_s_ = until_s;
  return from_seconds(std::max(0.0, until_s - elapsed_s));
}

Duration ClockFaults::suspension_due(double elapsed_s) {
  const double total_s =
      sim::drive_time_s(elapsed_s, faults_->all(sim::FaultInput::kClock)) - elapsed_s;
  const double new_s = std::max(0.0, total_s - suspended_s_);
  suspended_s_ = std::max(suspended_s_, total_s);
  return from_seconds(new_s);
}

}  // namespace bevloc::evaluation
