// AUTOSAR end-to-end (E2E) protection: protects the frames of a message and checks them.
#pragma once

#include <cstdint>
#include <optional>

#include "can/bus/frame.h"

namespace bevloc::can {

enum class E2eProfile : uint8_t {
  kP02,  ///< classic frames (e2e_p02.h); data ids of 8 bits, counters from 0 to 15
  kP05,  ///< FD frames (e2e_p05.h); data ids of 16 bits, counters from 0 to 255
};

/// How a message is protected.
struct E2eProtection {
  uint16_t data_id = 0;
  E2eProfile profile = E2eProfile::kP02;

  bool operator==(const E2eProtection&) const = default;
};

/// The largest counter of a profile: 15 or 255.
uint8_t highest_counter(E2eProfile profile);
/// The frame must have at least 2 bytes (P02) or 3 (P05).
uint8_t counter_of(const Frame& frame, E2eProfile profile);
bool has_valid_crc(const Frame& frame, const E2eProtection& protection);

/// Protects the frames of one message, in the order of sending. One thread.
class E2eSender {
 public:
  explicit E2eSender(const E2eProtection& protection) : protection_(protection) {}

  /// Writes the next counter and the CRC into the frame.
  void protect(Frame& frame);

 private:
  E2eProtection protection_;
  uint8_t counter_ = 0;
};

enum class E2eResult : uint8_t {
  kOk,
  kSomeLost,     ///< usable, although frames before it were lost
  kRepeated,     ///< not usable: it has the counter of the previous frame
  kWrongCrc,     ///< not usable: damaged, or a frame of another message
  kWrongLength,  ///< not usable
};

constexpr bool is_usable(E2eResult result) {
  return result == E2eResult::kOk || result == E2eResult::kSomeLost;
}

struct E2eCounters {
  uint64_t ok = 0;  ///< usable frames, including those after a loss
  uint64_t repeated = 0;
  uint64_t wrong_crc = 0;
  uint64_t wrong_length = 0;
  uint64_t lost = 0;  ///< frames missing between usable ones, counted modulo the counter's range
  uint64_t wrong_sequence = 0;  ///< E2eMonitor only: a counter that does not continue the sequence
  /// E2eMonitor only: good frames that came while the state was not VALID.
  uint64_t not_valid = 0;
};

/// Checks each frame of one message by itself, in the order of arrival. The caller has to detect
/// time-outs. E2eMonitor adds what a receiver in a vehicle needs. One thread.
class E2eChecker {
 public:
  E2eChecker(const E2eProtection& protection, uint8_t length)
      : protection_(protection), length_(length) {}

  E2eResult check(const Frame& frame);
  const E2eCounters& counters() const { return counters_; }

 private:
  E2eProtection protection_;
  uint8_t length_;
  std::optional<uint8_t> last_counter_;
  E2eCounters counters_;
};

}  // namespace bevloc::can
