// The protection of FD frames: AUTOSAR E2E profile P05 (AUTOSAR_PRS_E2EProtocol, 6.7).
#pragma once

#include <cstdint>
#include <span>

#include "can/frame.h"

namespace bevloc::can {

/// CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, no final xor; 0x29B1 on "123456789". It
/// finds every error of up to 3 bits in up to 32751 bits.
uint16_t crc16_ccitt_false(std::span<const uint8_t> bytes);

/// Bytes 0 and 1 are the CRC, low byte first, over the bytes from 2 on and then the data id, low
/// byte first. Byte 2 is the counter. The rest of the frame stays; it has at least 3 bytes.
void protect_p05(Frame& frame, uint16_t data_id, uint8_t counter);

/// Whether bytes 0 and 1 are what protect_p05() would write. The frame has at least 3 bytes.
bool has_sound_crc_p05(const Frame& frame, uint16_t data_id);

}  // namespace bevloc::can
