#include "evaluation/bench/cost_model.h"

#include <algorithm>

#include "evaluation/drive/error_statistics.h"

namespace bevloc::bench {

double MachinePeak::macs_per_s() const {
  return std::max(convolution_macs_per_s, matmul_macs_per_s);
}

double ideal_s(const Work& work, const MachinePeak& peak) {
  const double multiplying_s = peak.macs_per_s() > 0.0 ? work.macs / peak.macs_per_s() : 0.0;
  const double copying_s = peak.copy_bytes_per_s > 0.0 ? work.bytes / peak.copy_bytes_per_s : 0.0;
  return std::max(multiplying_s, copying_s);
}

TimeSummary summarize(const std::vector<double>& times_ms) {
  using evaluation::quantile_of;
  return {quantile_of(times_ms, 0.5), quantile_of(times_ms, 0.9), quantile_of(times_ms, 0.99),
          quantile_of(times_ms, 1.0)};
}

}  // namespace bevloc::bench
