// Faults of a sensor that sends old readings as new ones.
#pragma once

#include <cstddef>
#include <span>

#include "sim/faults/fault.h"

namespace bevloc::sim {

/// The kinds of one sensor that make it send an old reading.
struct OldReadingKinds {
  FaultKind stuck;  ///< it repeats the last reading before the fault
  FaultKind late;   ///< its readings are `delay_ms` old
};

/// The index of the reading that a sensor with this period sends when the reading `due` is due.
/// The times of the `active` faults are those of the drive.
size_t sent_index(size_t due, double period_s, OldReadingKinds kinds,
                  std::span<const Fault> active);

}  // namespace bevloc::sim
