#include "can/e2e/e2e_p02.h"

#include <array>
#include <cassert>

namespace bevloc::can {
namespace {

constexpr uint8_t kPolynomial = 0x2F;
constexpr uint8_t kStart = 0xFF;
constexpr uint8_t kFinalXor = 0xFF;

constexpr std::array<uint8_t, 256> kTable = [] {
  std::array<uint8_t, 256> table{};
  for (unsigned byte = 0; byte < table.size(); ++byte) {
    unsigned remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder << 1) ^ ((remainder & 0x80) != 0 ? kPolynomial : 0u);
    }
    table[byte] = static_cast<uint8_t>(remainder);
  }
  return table;
}();

uint8_t remainder_of(std::span<const uint8_t> bytes) {
  uint8_t remainder = kStart;
  for (const uint8_t byte : bytes) remainder = kTable[remainder ^ byte];
  return remainder;
}

uint8_t crc_of(const Frame& frame, uint8_t data_id) {
  return crc8_h2f(frame.payload().subspan(1), data_id);
}

}  // namespace

uint8_t crc8_h2f(std::span<const uint8_t> bytes) {
  return static_cast<uint8_t>(remainder_of(bytes) ^ kFinalXor);
}

uint8_t crc8_h2f(std::span<const uint8_t> bytes, uint8_t data_id) {
  return static_cast<uint8_t>(kTable[remainder_of(bytes) ^ data_id] ^ kFinalXor);
}

void protect_p02(Frame& frame, uint8_t data_id, uint8_t counter) {
  assert(frame.length >= 2 && frame.length <= kMaxClassicLength && counter <= 0x0F);
  frame.data[1] = static_cast<uint8_t>((frame.data[1] & 0xF0) | counter);
  frame.data[0] = crc_of(frame, data_id);
}

bool has_valid_crc_p02(const Frame& frame, uint8_t data_id) {
  assert(frame.length >= 2);
  return frame.data[0] == crc_of(frame, data_id);
}

}  // namespace bevloc::can
