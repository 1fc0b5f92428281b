// Counts latencies in fixed ranges.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "common/time.h"

namespace bevloc::firmware {

/// The counts of one LatencyHistogram at one moment.
struct LatencyCounts {
  /// Upper ends of the ranges. The last range has no end.
  static constexpr std::array kUpper_ms = {10.0,  20.0,  30.0,  40.0,  50.0,  60.0,  80.0,
                                           100.0, 120.0, 150.0, 200.0, 300.0, 500.0, 1000.0};
  static constexpr size_t kRanges = kUpper_ms.size() + 1;

  std::array<uint64_t, kRanges> in_range{};
  Duration sum{};

  uint64_t total() const {
    uint64_t total = 0;
    for (const uint64_t count : in_range) total += count;
    return total;
  }

  /// Returns the latency that the share `quantile` (0 to 1) does not exceed. It is interpolated
  /// within a range. If it lies in the last range, returns the start of that range. Returns 0 if
  /// there is no latency.
  double quantile_ms(double quantile) const {
    const double wanted = quantile * static_cast<double>(total());
    double below = 0.0;
    for (size_t range = 0; range + 1 < kRanges; ++range) {
      const auto count = static_cast<double>(in_range[range]);
      if (count > 0.0 && below + count >= wanted) {
        const double from_ms = range == 0 ? 0.0 : kUpper_ms[range - 1];
        return from_ms + (kUpper_ms[range] - from_ms) * (wanted - below) / count;
      }
      below += count;
    }
    return total() == 0 ? 0.0 : kUpper_ms.back();
  }
};

/// Thread-bound: add() is called from one thread. counts() is readable from any thread. Does not
/// allocate or wait.
class LatencyHistogram {
 public:
  void add(Duration latency) {
    const double latency_ms = to_milliseconds(latency);
    size_t range = 0;
    while (range < LatencyCounts::kUpper_ms.size() &&
           latency_ms > LatencyCounts::kUpper_ms[range]) {
      ++range;
    }
    in_range_[range].fetch_add(1, std::memory_order_relaxed);
    sum_ns_.fetch_add(latency.count(), std::memory_order_relaxed);
  }

  LatencyCounts counts() const {
    LatencyCounts counts;
    for (size_t range = 0; range < in_range_.size(); ++range) {
      counts.in_range[range] = in_range_[range].load(std::memory_order_relaxed);
    }
    counts.sum = Duration(sum_ns_.load(std::memory_order_relaxed));
    return counts;
  }

 private:
  std::array<std::atomic<uint64_t>, LatencyCounts::kRanges> in_range_{};
  std::atomic<int64_t> sum_ns_{0};
};

}  // namespace bevloc::firmware
