// Measures the practical peak of the machine, with which stages are compared.
#pragma once

#include <string>

#include "evaluation/bench/cost_model.h"

namespace bevloc::bench {

/// Medians of several runs on `threads` threads: int8 products (int8_peak.h), and a copy of 64 MiB.
/// Takes about half a second. Call it after the network is loaded, because that fixes the
/// instruction set.
MachinePeak measure_machine(int threads);

/// The processor's name in /proc/cpuinfo; where it has none, as on arm64, the board's name in the
/// device tree; else "unknown".
std::string processor_name();

}  // namespace bevloc::bench
