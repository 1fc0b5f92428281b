// Measures how fast the network's own kernels multiply int8.
#pragma once

#include "evaluation/bench/timing.h"

namespace bevloc::bench {

/// Multiply-accumulates per second of the fastest of the network's kernels (strip_kernels.h) on
/// `threads` threads: a 3 x 3 convolution of 64 channels whose data fit a core's own cache.
double strip_macs_per_s(int threads, const TimeOfRun& time_s);

}  // namespace bevloc::bench
