// The practical peak of the machine, against which stages are held.
#pragma once

#include <string>

#include "firmware/bench/cost_model.h"

namespace bevloc::bench {

/// The median of some repeats on `threads` threads: int8 products (int8_peak.h), and a copy of 64
/// MiB. Takes about half a second. To be called once the network's instruction set is settled.
MachinePeak measure_machine(int threads);

/// As /proc/cpuinfo names it; "unknown" where it does not.
std::string processor_name();

}  // namespace bevloc::bench
