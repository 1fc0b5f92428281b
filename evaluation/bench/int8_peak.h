// Measures how fast this machine multiplies int8.
#pragma once

#include <string>

#include "evaluation/bench/timing.h"

namespace bevloc::bench {

/// Multiply-accumulates per second; 0 if they were not measured.
struct Int8Peak {
  double convolution_macs_per_s = 0.0;
  double matmul_macs_per_s = 0.0;
};

/// On x86-64, measures with oneDNN: a 3 x 3 convolution of 256 to 256 channels on 6 x 32 x 56, and
/// a product of two 1024 x 1024 matrices. The process must not limit its instruction set. On arm64,
/// measures the network's own kernels (strip_peak.h) and no product of matrices, because Debian's
/// oneDNN has no fast int8 code for arm64.
Int8Peak measure_int8_peak(int threads, const TimeOfRun& time_s);

/// The instruction set that the network uses in this process: on x86-64 by oneDNN's name, on arm64
/// by that of the network's own kernels.
std::string instruction_set();

}  // namespace bevloc::bench
