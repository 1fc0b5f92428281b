// Puts together the frames of one measurement that needs several messages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "can/frame.h"

namespace bevloc::can {

/// Collects one frame of each of `kMembers` messages with the same EPOCH. An epoch has only 16
/// values, so frames further apart than `window` never belong together.
template <size_t kMembers>
class EpochGroup {
 public:
  explicit EpochGroup(Duration window) : window_(window) {}

  struct Set {
    std::array<Frame, kMembers> frames;
    Time received{};  ///< of the set's first frame
  };

  /// The complete set when this frame was its last one. A frame of another epoch starts a new set;
  /// incomplete() counts those given up.
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

  uint64_t incomplete() const { return incomplete_; }

 private:
  Duration window_;
  Set set_;
  uint8_t epoch_ = 0;
  unsigned present_ = 0;
  uint64_t incomplete_ = 0;
};

}  // namespace bevloc::can
