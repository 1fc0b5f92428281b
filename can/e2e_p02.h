// The protection of classic frames: AUTOSAR E2E profile P02 (AUTOSAR_PRS_E2EProtocol, 6.4).
#pragma once

#include <cstdint>
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

/// Whether byte 0 is what protect_p02() would write. The frame has at least 2 bytes.
bool has_sound_crc_p02(const Frame& frame, uint8_t data_id);

}  // namespace bevloc::can
