// Allows at most one frame of each identifier in the kernel's send queue.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/time.h"

namespace bevloc::can {

/// Lets one frame of each identifier into the kernel at a time. So no queue of old frames builds up
/// while the bus acknowledges nothing, and none is sent when the bus recovers. A frame has left the
/// kernel when its echo confirms that it was on the wire.
///
/// Threads: one thread calls enter() and leave(), another one confirm(). Both may call reset(). No
/// locks.
class SendGate {
 public:
  static constexpr size_t kMaxIds = 16;
  /// A frame without an echo for this time counts as lost in the controller (one-shot mode,
  /// restart), and the next frame may enter.
  static constexpr Duration kGiveUp = std::chrono::seconds(1);

  /// Frames with other identifiers always pass. Pass no identifiers when there are no echoes.
  explicit SendGate(std::span<const uint32_t> ids);

  /// Occupies the place of `id`; false when another frame of this identifier is still in the
  /// kernel. Call it before the frame goes to the kernel, as the echo can arrive before that call
  /// returns.
  bool enter(uint32_t id, Time now);
  /// Frees the place of `id` when the kernel did not take the frame.
  void leave(uint32_t id);

  /// Frees the place of `id` and returns how long the frame was in the kernel. Returns nothing when
  /// no frame of this identifier was in the kernel.
  std::optional<Duration> confirm(uint32_t id, Time echoed);

  /// Frees all places. To be called when the kernel's queue is empty: the interface went down, or
  /// the controller restarted.
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
