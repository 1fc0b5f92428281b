// The sign of life of one thread.
#pragma once

#include <atomic>
#include <cstdint>

#include "common/time.h"

namespace bevloc::firmware {

/// A counter that a thread increments at each turn of its loop. The watchdog (watchdog.h) compares
/// it with an earlier value, so that a beat needs no clock. Never blocks. Thread-bound: beat() and
/// end() are called from the thread that beats. The rest is readable from any thread.
class Heartbeat {
 public:
  /// The usual deadline, which every loop meets. Together with the period of the watchdog it is
  /// below one second.
  static constexpr Duration kDeadline = std::chrono::milliseconds(800);

  /// The next beat follows within `deadline`.
  void beat(Duration deadline = kDeadline) {
    // A reader that reads the deadline first never applies a new deadline to an old count.
    count_.fetch_add(1, std::memory_order_release);
    deadline_.store(deadline, std::memory_order_release);
  }

  /// The thread has ended in good order. It need not beat any more.
  void end() { ended_.store(true, std::memory_order_release); }

  uint64_t count() const { return count_.load(std::memory_order_acquire); }
  /// Read it before count(), if both are judged together.
  Duration deadline() const { return deadline_.load(std::memory_order_acquire); }
  bool ended() const { return ended_.load(std::memory_order_acquire); }

 private:
  std::atomic<uint64_t> count_{0};
  std::atomic<Duration> deadline_{kDeadline};
  std::atomic<bool> ended_{false};
};

}  // namespace bevloc::firmware
