// Collects the frames of one measurement that is sent in several messages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "can/bus/frame.h"

namespace bevloc::can {

/// Collects one frame of each of `kMembers` messages with the same EPOCH. The epoch repeats after
/// 16 measurements, so frames that are further apart than `window` are never combined. One thread.
template <size_t kMembers>
class EpochGroup {
 public:
  explicit EpochGroup(Duration window) : window_(window) {}

  struct Set {
    std::array<Frame, kMembers> frames;
    Time received{};  ///< when the first frame of the set arrived
  };

  /// Adds a frame of the message with number `member` and returns the set when it is complete. A
  /// frame of another epoch starts a new set.
  std::optional<Set> add(size_t member, uint8_t epoch, const ReceivedFrame& received) {
    const bool continues = present_ != 0 && epoch == epoch_ &&
                           received.received - set_.received <= window_ &&
                           (present_ >> member & 1) == 0;
    if (!continues) {
      if (present_ != 0) ++incomplete_;
      present_ = 0;
      epoch_ = epoch;
      set_.received = received.received;
    }
    set_.frames[member] = received.frame;
    present_ |= 1u << member;
    if (present_ != (1u << kMembers) - 1) return std::nullopt;
    present_ = 0;
    return set_;
  }

  /// Number of sets that were dropped because a frame was missing.
  uint64_t incomplete() const { return incomplete_; }

 private:
  Duration window_;
  Set set_;
  uint8_t epoch_ = 0;
  unsigned present_ = 0;  ///< bit i is set if the frame of message i is in set_
  uint64_t incomplete_ = 0;
};

}  // namespace bevloc::can
