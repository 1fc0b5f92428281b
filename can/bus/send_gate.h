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
/// Nobody can take a frame back from the kernel. So while the bus shows no sign of life, no further
/// frame enters. The kernel then holds only frames of the last 40 ms before the failure.
///
/// Threads: one thread calls enter() and leave(), another one confirm() and note_alive(). Both may
/// call reset(). No locks.
class SendGate {
 public:
  static constexpr size_t kMaxIds = 16;
  /// A frame without an echo counts as lost in the controller (one-shot mode, restart) when the bus
  /// was alive so long after it, and the next frame may enter. Time alone proves nothing: without
  /// an acknowledgement the controller repeats a frame for hours.
  static constexpr Duration kGiveUp = std::chrono::seconds(1);
  /// A frame without an echo for this time, while nothing else was on the bus, stalls all sending.
  static constexpr Duration kStall = std::chrono::milliseconds(40);

  /// Frames with other identifiers always pass. Pass no identifiers when there are no echoes.
  explicit SendGate(std::span<const uint32_t> ids);

  /// Occupies the place of `id`; false when another frame of this identifier is still in the
  /// kernel, or the bus is stalled. Call it before the frame goes to the kernel, as the echo can
  /// arrive before that call returns.
  bool enter(uint32_t id, Time now);
  /// Frees the place of `id` when the kernel did not take the frame.
  void leave(uint32_t id);

  /// Frees the place of `id` and returns how long the frame was in the kernel. Returns nothing when
  /// no frame of this identifier was in the kernel.
  std::optional<Duration> confirm(uint32_t id, Time echoed);

  /// The bus is alive: a frame of another node arrived.
  void note_alive(Time now);
  bool is_stalled(Time now) const;

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
  std::atomic<int64_t> alive_ns_{kNone};  ///< the latest sign of life of the bus
};

}  // namespace bevloc::can
