// AUTOSAR E2E profile P05, which protects CAN FD frames (AUTOSAR_PRS_E2EProtocol, 6.7).
#pragma once

#include <cstdint>
#include <span>

#include "can/bus/frame.h"

namespace bevloc::can {

/// CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, no final xor; check value 0x29B1 for
/// "123456789". It detects every error of up to 3 bits in up to 32751 bits.
uint16_t crc16_ccitt_false(std::span<const uint8_t> bytes);

/// Writes the counter into byte 2, and the CRC into bytes 0 and 1, low byte first. The CRC covers
/// all bytes from byte 2 on and then the data id, low byte first. The frame must have at least 3
/// bytes.
void protect_p05(Frame& frame, uint16_t data_id, uint8_t counter);

/// Whether bytes 0 and 1 are the values that protect_p05() would write. The frame must have at
/// least 3 bytes.
bool has_valid_crc_p05(const Frame& frame, uint16_t data_id);

}  // namespace bevloc::can
