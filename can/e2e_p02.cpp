#include "can/e2e_p02.h"

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

uint8_t counter_of(const Frame& frame) {
  return frame.data[1] & 0x0F;
}

}  // namespace

uint8_t crc8_h2f(std::span<const uint8_t> bytes) {
  return static_cast<uint8_t>(remainder_of(bytes) ^ kFinalXor);
}

uint8_t crc8_h2f(std::span<const uint8_t> bytes, uint8_t data_id) {
  return static_cast<uint8_t>(kTable[remainder_of(bytes) ^ data_id] ^ kFinalXor);
}

void protect_p02(Frame& frame, uint8_t data_id, uint8_t counter) {
  assert(frame.length >= 2 && frame.length <= kMaxFrameLength && counter <= 0x0F);
  frame.data[1] = static_cast<uint8_t>((frame.data[1] & 0xF0) | counter);
  frame.data[0] = crc_of(frame, data_id);
}

E2eResult E2eChecker::check(const Frame& frame) {
  if (frame.length != length_) {
    ++counters_.wrong_length;
    return E2eResult::kWrongLength;
  }
  if (frame.data[0] != crc_of(frame, data_id_)) {
    ++counters_.wrong_crc;
    return E2eResult::kWrongCrc;
  }
  const uint8_t counter = counter_of(frame);
  if (last_counter_ == counter) {
    ++counters_.repeated;
    return E2eResult::kRepeated;
  }
  const int lost = last_counter_ ? (counter - *last_counter_ - 1) & 0x0F : 0;
  last_counter_ = counter;
  ++counters_.ok;
  counters_.lost += static_cast<uint64_t>(lost);
  return lost == 0 ? E2eResult::kOk : E2eResult::kSomeLost;
}

}  // namespace bevloc::can
