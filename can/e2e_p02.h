// End-to-end protection of frames: AUTOSAR E2E profile P02 (AUTOSAR_PRS_E2EProtocol, 6.4).
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "can/frame.h"

namespace bevloc::can {

/// CRC-8H2F: polynomial 0x2F, start 0xFF, final xor 0xFF; 0xDF on "123456789". It finds every error
/// of up to 3 bits in up to 127 bits. `data_id` is appended to the bytes as the profile wants it.
uint8_t crc8_h2f(std::span<const uint8_t> bytes);
uint8_t crc8_h2f(std::span<const uint8_t> bytes, uint8_t data_id);

/// Byte 0 is the CRC and the low nibble of byte 1 the counter; the rest of the frame stays. The
/// data id is the same for all 16 counters: a list that changes with the counter misses some 2- and
/// 3-bit errors that touch the counter. The frame has at least 2 bytes.
void protect_p02(Frame& frame, uint8_t data_id, uint8_t counter);

/// Protects the frames of one message, one after the other.
class E2eSender {
 public:
  explicit E2eSender(uint8_t data_id) : data_id_(data_id) {}

  void protect(Frame& frame) {
    protect_p02(frame, data_id_, counter_);
    counter_ = (counter_ + 1) & 0x0F;
  }

 private:
  uint8_t data_id_;
  uint8_t counter_ = 0;
};

enum class E2eResult : uint8_t {
  kOk,
  kSomeLost,     ///< sound, but frames before it are missing
  kRepeated,     ///< sound, but its counter is that of the last one: not to be used
  kWrongCrc,     ///< damaged, or a frame of another message: not to be used
  kWrongLength,  ///< not to be used
};

constexpr bool is_usable(E2eResult result) {
  return result == E2eResult::kOk || result == E2eResult::kSomeLost;
}

struct E2eCounters {
  uint64_t ok = 0;  ///< usable frames, including those after a loss
  uint64_t repeated = 0;
  uint64_t wrong_crc = 0;
  uint64_t wrong_length = 0;
  uint64_t lost = 0;  ///< frames missing between usable ones, modulo 16 each time
};

/// Checks the frames of one message, one after the other. A time-out is the caller's to notice.
class E2eChecker {
 public:
  E2eChecker(uint8_t data_id, uint8_t length) : data_id_(data_id), length_(length) {}

  E2eResult check(const Frame& frame);
  const E2eCounters& counters() const { return counters_; }

 private:
  uint8_t data_id_;
  uint8_t length_;
  std::optional<uint8_t> last_counter_;
  E2eCounters counters_;
};

}  // namespace bevloc::can
