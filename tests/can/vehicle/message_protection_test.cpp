#include "can/vehicle/message_protection.h"

#include <string_view>

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

MessageProtection protection_of(ChecksumKind kind) {
  MessageProtection protection;
  protection.checksum = kind;
  if (!protection.is_profile()) {
    protection.checksum_byte = 7;
    protection.counter = SignalLayout{.start_bit = 52, .length_bits = 4};
  }
  protection.data_ids = {0x4D};
  return protection;
}

Frame some_frame() {
  return {.id = 0x120, .length = 8, .data = {1, 2, 3, 4, 5, 6, 0x70, 8}};
}

TEST(MessageProtectionTest, ComputesTheCrcOfSaeJ1850) {
  Crc8Sae crc;
  for (const char c : std::string_view("123456789")) crc.add(static_cast<uint8_t>(c));
  EXPECT_EQ(crc.value(), 0x4B);
}

TEST(MessageProtectionTest, AcceptsWhatItProtectsAndNoOtherByte) {
  for (const ChecksumKind kind : {ChecksumKind::kXor, ChecksumKind::kCrc8Sae,
                                  ChecksumKind::kCrc8H2f, ChecksumKind::kE2eP02}) {
    const MessageProtection protection = protection_of(kind);
    for (const uint8_t counter : {uint8_t{0}, uint8_t{7}, uint8_t{15}}) {
      Frame frame = some_frame();
      protect(frame, protection, counter);
      const E2eFrame good = e2e_frame_of(frame, protection, 8);
      EXPECT_TRUE(good.right_length && good.right_crc);
      EXPECT_EQ(good.counter, counter);
      for (size_t byte = 0; byte < 8; ++byte) {
        Frame damaged = frame;
        damaged.data[byte] ^= 0x10;
        EXPECT_FALSE(e2e_frame_of(damaged, protection, 8).right_crc) << byte;
      }
      EXPECT_FALSE(e2e_frame_of(frame, protection, 7).right_length);
      MessageProtection other = protection;
      other.data_ids = {0x4E};
      EXPECT_FALSE(e2e_frame_of(frame, other, 8).right_crc) << "of another message";
    }
  }
}

TEST(MessageProtectionTest, ChoosesTheDataIdByTheCounter) {
  MessageProtection protection = protection_of(ChecksumKind::kCrc8H2f);
  protection.data_ids.clear();
  for (uint16_t id = 0; id < 16; ++id) protection.data_ids.push_back(static_cast<uint16_t>(id * 7));
  Frame frame = some_frame();
  protect(frame, protection, 5);
  EXPECT_TRUE(e2e_frame_of(frame, protection, 8).right_crc);
  MessageProtection swapped = protection;
  std::swap(swapped.data_ids[5], swapped.data_ids[6]);
  EXPECT_FALSE(e2e_frame_of(frame, swapped, 8).right_crc);
}

TEST(MessageProtectionTest, XorIsTheSumOfTheOtherBytes) {
  MessageProtection protection = protection_of(ChecksumKind::kXor);
  protection.data_ids.clear();
  Frame frame = some_frame();
  protect(frame, protection, 0);
  EXPECT_EQ(frame.data[7], 1 ^ 2 ^ 3 ^ 4 ^ 5 ^ 6 ^ 0);
}

TEST(MessageProtectionTest, RefusesACounterBeyondTheHighest) {
  MessageProtection protection = protection_of(ChecksumKind::kXor);
  protection.highest_counter = 14;
  Frame frame = some_frame();
  protect(frame, protection, 15);
  EXPECT_FALSE(e2e_frame_of(frame, protection, 8).right_crc);
}

TEST(MessageProtectionTest, AcceptsMessagesWithoutProtection) {
  const E2eFrame frame = e2e_frame_of(some_frame(), MessageProtection{}, 8);
  EXPECT_TRUE(frame.right_length && frame.right_crc);
  EXPECT_FALSE(frame.counter);
}

}  // namespace
}  // namespace bevloc::can
