#include "can/e2e/e2e_p05.h"

#include <array>
#include <cassert>

namespace bevloc::can {
namespace {

constexpr uint16_t kCrc16Polynomial = 0x1021;
constexpr uint16_t kCrc16Start = 0xFFFF;

constexpr std::array<uint16_t, 256> kCrc16Table = [] {
  std::array<uint16_t, 256> table{};
  for (unsigned byte = 0; byte < table.size(); ++byte) {
    unsigned remainder = byte << 8;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder << 1) ^ ((remainder & 0x8000) != 0 ? kCrc16Polynomial : 0u);
    }
    table[byte] = static_cast<uint16_t>(remainder);
  }
  return table;
}();

uint16_t crc16_append(uint16_t remainder, uint8_t byte) {
  return static_cast<uint16_t>((remainder << 8) ^ kCrc16Table[(remainder >> 8) ^ byte]);
}

uint16_t p05_crc_of(const Frame& frame, uint16_t data_id) {
  uint16_t remainder = crc16_ccitt_false(frame.payload().subspan(2));
  remainder = crc16_append(remainder, static_cast<uint8_t>(data_id));
  return crc16_append(remainder, static_cast<uint8_t>(data_id >> 8));
}

}  // namespace

uint16_t crc16_ccitt_false(std::span<const uint8_t> bytes) {
  uint16_t remainder = kCrc16Start;
  for (const uint8_t byte : bytes) remainder = crc16_append(remainder, byte);
  return remainder;
}

void protect_p05(Frame& frame, uint16_t data_id, uint8_t counter) {
  assert(frame.length >= 3);
  frame.data[2] = counter;
  const uint16_t crc = p05_crc_of(frame, data_id);
  frame.data[0] = static_cast<uint8_t>(crc);
  frame.data[1] = static_cast<uint8_t>(crc >> 8);
}

bool has_valid_crc_p05(const Frame& frame, uint16_t data_id) {
  assert(frame.length >= 3);
  const uint16_t crc = p05_crc_of(frame, data_id);
  return frame.data[0] == static_cast<uint8_t>(crc) &&
         frame.data[1] == static_cast<uint8_t>(crc >> 8);
}

}  // namespace bevloc::can
