// Measures how fast this machine multiplies int8.
#pragma once

#include <functional>
#include <string>

namespace bevloc::bench {

/// Multiply-accumulates per second; 0 if they were not measured.
struct Int8Peak {
  double convolution_macs_per_s = 0.0;
  double matmul_macs_per_s = 0.0;
};

/// Calls `run` several times and returns the time of one run, in seconds.
using TimeOfRun = std::function<double(const std::function<void()>& run)>;

/// Measures with oneDNN: a 3 x 3 convolution of 256 to 256 channels on 6 x 32 x 56, and a product
/// of two 1024 x 1024 matrices. The process must not limit its instruction set.
Int8Peak measure_int8_peak(int threads, const TimeOfRun& time_s);

/// The instruction set that oneDNN uses in this process, by oneDNN's name.
std::string instruction_set();

}  // namespace bevloc::bench
