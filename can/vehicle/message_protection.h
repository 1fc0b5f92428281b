// How a message of the vehicle's own bus is protected: its counter and its checksum.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "can/bus/frame.h"
#include "can/dbc/signal_layout.h"
#include "can/e2e/e2e_monitor.h"

namespace bevloc::can {

enum class ChecksumKind : uint8_t {
  kNone,
  kXor,      ///< exclusive or of all bytes
  kCrc8Sae,  ///< SAE J1850: polynomial 0x1D, start 0xFF, final xor 0xFF
  kCrc8H2f,  ///< AUTOSAR: polynomial 0x2F, start 0xFF, final xor 0xFF
  kE2eP02,   ///< AUTOSAR E2E profile P02, with its own places for checksum and counter
  kE2eP05,   ///< AUTOSAR E2E profile P05, with its own places for checksum and counter
};

/// A checksum covers all bytes of the frame except its own, and after them the data id, if there is
/// one. In kXor the data id counts as one more byte. If there are 16 data ids, the frame's counter
/// chooses one.
struct MessageProtection {
  ChecksumKind checksum = ChecksumKind::kNone;
  size_t checksum_byte = 0;               ///< unused with the profiles and kNone
  std::optional<SignalLayout> counter{};  ///< at most 8 bits; unused with the profiles
  uint8_t highest_counter = 15;           ///< the counter after it is 0
  std::vector<uint16_t> data_ids{};       ///< none, 1 or 16 of 8 bits; one of 16 bits with kE2eP05

  bool has_counter() const { return counter || is_profile(); }
  bool is_profile() const {
    return checksum == ChecksumKind::kE2eP02 || checksum == ChecksumKind::kE2eP05;
  }
};

/// Computes the CRC-8 SAE J1850, whose check value for "123456789" is 0x4B. One thread.
class Crc8Sae {
 public:
  void add(uint8_t byte);
  uint8_t value() const { return static_cast<uint8_t>(remainder_ ^ 0xFF); }

 private:
  uint8_t remainder_ = 0xFF;
};

/// Checks the protection of a frame, whose message has `length` bytes. Does not allocate.
E2eFrame e2e_frame_of(const Frame& frame, const MessageProtection& protection, uint8_t length);

/// Writes counter and checksum.
void protect(Frame& frame, const MessageProtection& protection, uint8_t counter);

}  // namespace bevloc::can
