// How fast this machine multiplies int8 at best.
#pragma once

#include <functional>
#include <string>

namespace bevloc::bench {

/// Multiply-accumulates a second; zero where nothing is there to measure them.
struct Int8Peak {
  double convolution_macs_per_s = 0.0;
  double matmul_macs_per_s = 0.0;
};

/// Runs it some times and gives the time of one.
using TimeOfRun = std::function<double(const std::function<void()>& run)>;

/// By oneDNN: a convolution of 256 to 256 channels, 3 x 3, on 6 x 32 x 56, and a product of two
/// 1024 x 1024 matrices. In a process whose instruction set is not capped.
Int8Peak measure_int8_peak(int threads, const TimeOfRun& time_s);

/// The instructions that oneDNN uses in this process, as oneDNN names them.
std::string instruction_set();

}  // namespace bevloc::bench
