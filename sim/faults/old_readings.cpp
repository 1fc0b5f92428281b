#include "sim/faults/old_readings.h"

#include <algorithm>
#include <cmath>

namespace bevloc::sim {

size_t sent_index(size_t due, double period_s, OldReadingKinds kinds,
                  std::span<const Fault> active) {
  auto index = static_cast<double>(due);
  for (const Fault& fault : active) {
    if (fault.kind == kinds.stuck) {
      index = std::min(index, std::floor(fault.from_s / period_s));
    } else if (fault.kind == kinds.late) {
      index -= std::round(1e-3 * fault.amounts.delay_ms / period_s);
    }
  }
  return static_cast<size_t>(std::max(0.0, index));
}

}  // namespace bevloc::sim
