#include "can/e2e/e2e_p02.h"

#include <cassert>

#include "can/e2e/crc8.h"

namespace bevloc::can {
namespace {

constexpr uint8_t kCrc8Start = 0xFF;
constexpr uint8_t kCrc8FinalXor = 0xFF;
constexpr auto kCrc8Table = crc8_table(0x2F);

uint8_t crc8_remainder(std::span<const uint8_t> bytes) {
  uint8_t remainder = kCrc8Start;
  for (const uint8_t byte : bytes) remainder = kCrc8Table[remainder ^ byte];
  return remainder;
}

uint8_t p02_crc_of(const Frame& frame, uint8_t data_id) {
  return crc8_h2f(frame.payload().subspan(1), data_id);
}

}  // namespace

uint8_t crc8_h2f(std::span<const uint8_t> bytes) {
  return static_cast<uint8_t>(crc8_remainder(bytes) ^ kCrc8FinalXor);
}

uint8_t crc8_h2f(std::span<const uint8_t> bytes, uint8_t data_id) {
  return static_cast<uint8_t>(kCrc8Table[crc8_remainder(bytes) ^ data_id] ^ kCrc8FinalXor);
}

void protect_p02(Frame& frame, uint8_t data_id, uint8_t counter) {
  assert(frame.length >= 2 && frame.length <= kMaxClassicLength && counter <= 0x0F);
  frame.data[1] = static_cast<uint8_t>((frame.data[1] & 0xF0) | counter);
  frame.data[0] = p02_crc_of(frame, data_id);
}

bool has_valid_crc_p02(const Frame& frame, uint8_t data_id) {
  assert(frame.length >= 2);
  return frame.data[0] == p02_crc_of(frame, data_id);
}

}  // namespace bevloc::can
