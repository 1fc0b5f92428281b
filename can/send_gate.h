// Which identifiers have a frame in the kernel that the bus has not taken yet.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/time.h"

namespace bevloc::can {

/// Lets one frame of each identifier into the kernel at a time: behind a bus that acknowledges
/// nothing no queue of old frames builds up, to be sent when it comes back. A frame leaves when its
/// echo confirms that it was on the wire.
///
/// Threads: one hands frames over, another confirms; reset() is for either. No locks.
class SendGate {
 public:
  static constexpr size_t kMaxIds = 16;
  /// Without an echo for this long a frame counts as lost in the controller (one-shot mode, a
  /// restart), and the next one may try.
  static constexpr Duration kGiveUp = std::chrono::seconds(1);

  /// Identifiers beyond these pass freely; none means that there are no echoes.
  explicit SendGate(std::span<const uint32_t> ids);

  /// Takes the place of `id`, or says that a frame of it is still on its way. Before the frame goes
  /// to the kernel, as the echo may be quicker than the call.
  bool enter(uint32_t id, Time now);
  /// The kernel did not take the frame.
  void leave(uint32_t id);

  /// Says how long the frame was on its way, when it was one that is waited for.
  std::optional<Duration> confirm(uint32_t id, Time echoed);

  /// The kernel's queue is empty: the interface went down, or the controller restarted.
  void reset();

 private:
  static constexpr int64_t kNone = INT64_MIN;
  struct Slot {
    uint32_t id = 0;
    std::atomic<int64_t> handed_over_ns{kNone};
  };

  Slot* find(uint32_t id);

  std::array<Slot, kMaxIds> slots_;
  size_t count_ = 0;
};

}  // namespace bevloc::can
