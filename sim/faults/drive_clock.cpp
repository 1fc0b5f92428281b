#include "sim/faults/drive_clock.h"

#include <algorithm>

namespace bevloc::sim {

double drive_time_s(double elapsed_s, std::span<const Fault> faults) {
  double time_s = elapsed_s;
  for (const Fault& fault : faults) {
    if (fault.kind == FaultKind::kClockSuspend && elapsed_s >= fault.from_s) {
      time_s += fault.amounts.gap_s;
    }
  }
  return time_s;
}

bool is_in_clock_gap(double elapsed_s, std::span<const Fault> faults) {
  return std::ranges::any_of(faults, [elapsed_s](const Fault& fault) {
    return fault.kind == FaultKind::kClockGap && elapsed_s >= fault.from_s &&
           elapsed_s < fault.from_s + fault.amounts.gap_s;
  });
}

double added_time_s(std::span<const Fault> faults) {
  double added_s = 0.0;
  for (const Fault& fault : faults) {
    if (fault.kind == FaultKind::kClockSuspend) added_s += fault.amounts.gap_s;
  }
  return added_s;
}

}  // namespace bevloc::sim
