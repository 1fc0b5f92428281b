// The work of a stage, its ideal time at the machine's peak, and the summary of measured times.
#pragma once

#include <cstdint>
#include <vector>

namespace bevloc::bench {

inline constexpr double kMs_per_s = 1e3;

/// The work of a stage for one frame.
struct Work {
  double macs = 0.0;   ///< int8 multiply-accumulates
  double bytes = 0.0;  ///< read and written, each counted once; 0 if not meaningful
};

/// The measured peak of this machine. 0 if it cannot be measured.
struct MachinePeak {
  double convolution_macs_per_s = 0.0;
  double matmul_macs_per_s = 0.0;
  double copy_bytes_per_s = 0.0;  ///< bytes read plus bytes written

  /// The better of convolution and matrix product.
  double macs_per_s() const;
};

/// The time at the peak: multiplying or copying, whichever takes longer. Multiplying is ignored if
/// its peak is unknown.
double ideal_s(const Work& work, const MachinePeak& peak);

/// Quantiles by nearest rank (quantile_of()). All zero if there are no times.
struct TimeSummary {
  double p50_ms = 0.0;
  double p90_ms = 0.0;
  double p99_ms = 0.0;
  double max_ms = 0.0;
};
TimeSummary summarize(const std::vector<double>& times_ms);

}  // namespace bevloc::bench
