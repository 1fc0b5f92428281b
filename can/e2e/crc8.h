// The table of a CRC of eight bits that takes the highest bit of each byte first.
#pragma once

#include <array>
#include <cstdint>

namespace bevloc::can {

/// The remainder of each byte, divided by the polynomial (without its term x^8).
consteval std::array<uint8_t, 256> crc8_table(unsigned polynomial) {
  std::array<uint8_t, 256> table{};
  for (unsigned byte = 0; byte < table.size(); ++byte) {
    unsigned remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder << 1) ^ ((remainder & 0x80) != 0 ? polynomial : 0U);
    }
    table[byte] = static_cast<uint8_t>(remainder);
  }
  return table;
}

}  // namespace bevloc::can
