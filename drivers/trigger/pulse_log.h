// The times of the latest trigger pulses.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "common/time.h"

namespace bevloc::drivers {

/// Keeps the newest kCapacity pulses. Thread-bound: add() is called from the trigger thread. The
/// rest is readable from any thread, without a lock. So this is an array of atomics, because
/// boost::circular_buffer is not thread-safe.
class PulseLog {
 public:
  static constexpr int kCapacity = 64;

  /// Adds a pulse. `rise` must be later than that of the previous pulse.
  void add(Time rise) {
    const uint64_t count = count_.load(std::memory_order_relaxed);
    rises_[count % kCapacity].store(rise, std::memory_order_relaxed);
    count_.store(count + 1, std::memory_order_release);
  }

  /// Number of pulses since construction.
  uint64_t count() const { return count_.load(std::memory_order_acquire); }

  /// Returns the newest pulse at or before `time`, which triggered a frame of that time. Returns
  /// nothing when there was no such pulse, or when kCapacity - 1 or more pulses have followed.
  std::optional<Time> newest_until(Time time) const {
    const uint64_t count = this->count();
    // The oldest entry may be overwritten at the same time, so it is not used.
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
