#include "sim/faults/drive_clock.h"

#include <algorithm>

namespace bevloc::sim {

namespace {

bool happens(const Fault& fault, FaultKind kind) {
  return fault.kind == kind && fault.until_s > fault.from_s;
}

}  // namespace

double drive_time_s(double elapsed_s, std::span<const Fault> faults) {
  double time_s = elapsed_s;
  for (const Fault& fault : faults) {
    if (happens(fault, FaultKind::kClockSuspend) && elapsed_s >= fault.from_s) {
      time_s += fault.amounts.gap_s;
    }
  }
  return time_s;
}

bool is_in_clock_gap(double elapsed_s, std::span<const Fault> faults) {
  return std::ranges::any_of(faults, [elapsed_s](const Fault& fault) {
    return happens(fault, FaultKind::kClockGap) && elapsed_s >= fault.from_s &&
           elapsed_s < fault.from_s + fault.amounts.gap_s;
  });
}

double clock_gaps_end_s(double elapsed_s, std::span<const Fault> faults) {
  double end_s = 0.0;
  for (const Fault& fault : faults) {
    if (!happens(fault, FaultKind::kClockGap) || elapsed_s < fault.from_s) continue;
    end_s = std::max(end_s, fault.from_s + fault.amounts.gap_s);
  }
  return end_s;
}

std::vector<Fault> in_drive_time(std::vector<Fault> faults, std::span<const Fault> clock_faults) {
  for (Fault& fault : faults) {
    fault.from_s = drive_time_s(fault.from_s, clock_faults);
    fault.until_s = drive_time_s(fault.until_s, clock_faults);
  }
  return faults;
}

double added_time_s(std::span<const Fault> faults) {
  double added_s = 0.0;
  for (const Fault& fault : faults) {
    if (happens(fault, FaultKind::kClockSuspend)) added_s += fault.amounts.gap_s;
  }
  return added_s;
}

}  // namespace bevloc::sim
