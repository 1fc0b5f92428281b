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
/// while the bus acknowledges nothing, and no old frames are sent when the bus recovers. A frame
/// has left the kernel when its echo confirms that it was on the wire.
///
/// Nobody can take a frame back from the kernel. So while the bus shows no sign of life, no further
/// frame enters. The kernel then holds only frames of the last 40 ms before the failure.
///
/// Thread-bound: enter() and leave() are called from the sending thread of the bus, confirm() and
/// note_alive() from its receiving thread, and reset() from both. There are no locks.
class SendGate {
 public:
  static constexpr size_t kMaxIds = 16;
  /// If the bus was alive this long after a frame, and the frame has no echo, the controller has
  /// lost it (one-shot mode, restart), and the next frame may enter. Time alone proves nothing,
  /// because a controller without an acknowledgement repeats a frame for hours.
  static constexpr Duration kGiveUp = std::chrono::seconds(1);
  /// If a frame has no echo for this time, and nothing else was on the bus, all sending stalls.
  static constexpr Duration kStall = std::chrono::milliseconds(40);

  /// Frames with identifiers that are not in `ids` always pass. `ids` must be empty if the bus
  /// gives no echoes.
  explicit SendGate(std::span<const uint32_t> ids);

  /// Occupies the place of `id`. Returns false when another frame of this identifier is still in
  /// the kernel, or the bus is stalled. Call it before the frame goes to the kernel, because the
  /// echo can arrive before the kernel's call returns.
  bool enter(uint32_t id, Time now);
  /// Frees the place of `id` when the kernel did not take the frame.
  void leave(uint32_t id);

  /// Frees the place of `id` and returns how long the frame was in the kernel. Returns nothing when
  /// no frame of this identifier was in the kernel.
  std::optional<Duration> confirm(uint32_t id, Time echoed);

  /// Notes that the bus is alive, because a frame of another node arrived.
  void note_alive(Time now);
  bool is_stalled(Time now) const;

  /// Frees all places. Call it when the kernel's queue is empty: the interface went down, or the
  /// controller restarted while no frame was in the queue.
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
  std::atomic<int64_t> alive_ns_{kNone};  ///< the latest sign of life of the bus
};

}  // namespace bevloc::can
