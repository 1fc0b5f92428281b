// AUTOSAR E2E profile P02, which protects classic frames (AUTOSAR_PRS_E2EProtocol, 6.4).
#pragma once

#include <cstdint>
#include <span>

#include "can/bus/frame.h"

namespace bevloc::can {

/// CRC-8H2F: polynomial 0x2F, start 0xFF, final xor 0xFF; check value 0xDF for "123456789". It
/// detects every error of up to 3 bits in up to 127 bits. The second form appends `data_id` to the
/// bytes, as the profile demands.
uint8_t crc8_h2f(std::span<const uint8_t> bytes);
uint8_t crc8_h2f(std::span<const uint8_t> bytes, uint8_t data_id);

/// Writes the CRC into byte 0 and the counter into the low nibble of byte 1. All 16 counters use
/// the same data id: with a list of data ids, some 2-bit and 3-bit errors that change the counter
/// would not be detected. The frame must have at least 2 bytes.
void protect_p02(Frame& frame, uint8_t data_id, uint8_t counter);

/// Whether byte 0 is the value that protect_p02() would write. The frame must have at least 2
/// bytes.
bool has_valid_crc_p02(const Frame& frame, uint8_t data_id);

}  // namespace bevloc::can
