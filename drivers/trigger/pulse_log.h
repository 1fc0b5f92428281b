// When the latest trigger pulses were given.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "common/time.h"

namespace bevloc::drivers {

/// Written by one thread, read by any, without a lock. Holds the newest pulses.
class PulseLog {
 public:
  static constexpr int kCapacity = 64;

  /// `rise` is later than the one before.
  void add(Time rise) {
    const uint64_t count = count_.load(std::memory_order_relaxed);
    rises_[count % kCapacity].store(rise, std::memory_order_relaxed);
    count_.store(count + 1, std::memory_order_release);
  }

  /// Since start.
  uint64_t count() const { return count_.load(std::memory_order_acquire); }

  /// The newest pulse at or before `time`: the one that a frame of that time answers. Nothing when
  /// there was none, or more than kCapacity have followed.
  std::optional<Time> newest_until(Time time) const {
    const uint64_t count = this->count();
    // The oldest may be overwritten meanwhile.
    const uint64_t kept = count < kCapacity ? count : kCapacity - 1;
    for (uint64_t back = 1; back <= kept; ++back) {
      const Time rise = rises_[(count - back) % kCapacity].load(std::memory_order_relaxed);
      if (rise <= time) return rise;
    }
    return std::nullopt;
  }

 private:
  std::array<std::atomic<Time>, kCapacity> rises_{};
  std::atomic<uint64_t> count_{0};
};

}  // namespace bevloc::drivers
