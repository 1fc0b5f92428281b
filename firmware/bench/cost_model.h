// What a stage does, how long that would take at the machine's own best, and how long it took.
#pragma once

#include <cstdint>
#include <vector>

namespace bevloc::bench {

/// Of one frame.
struct Work {
  double macs = 0.0;   ///< int8 multiply-accumulates
  double bytes = 0.0;  ///< read and written, each once; 0 where it says nothing
};

/// What this machine reaches, measured; of what cannot be measured, zero.
struct MachinePeak {
  double convolution_macs_per_s = 0.0;
  double matmul_macs_per_s = 0.0;
  double copy_bytes_per_s = 0.0;  ///< read and written

  double macs_per_s() const;
};

/// The longer of the two: multiplying at the peak, where that is known, or moving the bytes at the
/// copy's speed.
double ideal_s(const Work& work, const MachinePeak& peak);

/// Nearest rank; all zero for no times.
struct TimeSummary {
  double p50_ms = 0.0;
  double p90_ms = 0.0;
  double p99_ms = 0.0;
  double max_ms = 0.0;
};
TimeSummary summarize(const std::vector<double>& times_ms);

}  // namespace bevloc::bench
