#include "can/dbc/signal_layout.h"

#include <array>
#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

TEST(SignalLayoutTest, ReadsBothByteOrders) {
  const std::array<uint8_t, 8> bytes = {0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0};
  EXPECT_EQ(raw_bits_from({.start_bit = 0, .length_bits = 16}, bytes), 0x3412U);
  EXPECT_EQ(
      raw_bits_from({.start_bit = 7, .length_bits = 16, .order = ByteOrder::kMotorola}, bytes),
      0x1234U);
  EXPECT_EQ(raw_bits_from({.start_bit = 4, .length_bits = 12}, bytes), 0x341U);
  EXPECT_EQ(
      raw_bits_from({.start_bit = 3, .length_bits = 12, .order = ByteOrder::kMotorola}, bytes),
      0x234U);
  EXPECT_EQ(
      raw_bits_from({.start_bit = 7, .length_bits = 64, .order = ByteOrder::kMotorola}, bytes),
      0x123456789ABCDEF0U);
}

TEST(SignalLayoutTest, ReadsSignsFloatsAndScaling) {
  std::array<uint8_t, 8> bytes = {0xFE, 0xFF};
  const SignalLayout layout{
      .start_bit = 0, .length_bits = 16, .type = RawType::kSigned, .scale = 0.5, .offset = 10.0};
  EXPECT_EQ(raw_from(layout, bytes), -2);
  EXPECT_DOUBLE_EQ(physical_from(layout, bytes), 9.0);
  const SignalLayout real{.start_bit = 31,
                          .length_bits = 32,
                          .order = ByteOrder::kMotorola,
                          .type = RawType::kFloat,
                          .scale = 2.0};
  bytes = {0, 0, 0, 0x3F, 0x80, 0, 0, 0};
  EXPECT_DOUBLE_EQ(physical_from(real, bytes), 2.0);
}

TEST(SignalLayoutTest, KnowsTheBytesThatItNeeds) {
  EXPECT_EQ(bytes_needed({.start_bit = 0, .length_bits = 8}), 1U);
  EXPECT_EQ(bytes_needed({.start_bit = 4, .length_bits = 8}), 2U);
  EXPECT_EQ(bytes_needed({.start_bit = 7, .length_bits = 16, .order = ByteOrder::kMotorola}), 2U);
  EXPECT_EQ(bytes_needed({.start_bit = 0, .length_bits = 2, .order = ByteOrder::kMotorola}), 2U);
}

TEST(SignalLayoutTest, WritesWhatItReads) {
  std::mt19937 random(7);
  for (int i = 0; i < 2000; ++i) {
    SignalLayout layout;
    layout.length_bits = 1 + static_cast<int>(random() % 64);
    layout.order = random() % 2 == 0 ? ByteOrder::kIntel : ByteOrder::kMotorola;
    layout.start_bit = static_cast<int>(random() % 64);
    if (bytes_needed(layout) > 9) continue;
    std::array<uint8_t, 9> bytes{};
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
    const auto before = bytes;
    const uint64_t mask = layout.length_bits == 64 ? UINT64_MAX : (1ULL << layout.length_bits) - 1;
    const uint64_t raw = (uint64_t{random()} << 32 | random()) & mask;
    insert_bits(layout, raw, bytes);
    EXPECT_EQ(raw_bits_from(layout, bytes), raw);
    insert_bits(layout, raw_bits_from(layout, before), bytes);
    EXPECT_EQ(bytes, before) << "other bits changed";
  }
}

TEST(SignalLayoutTest, LimitsAndRoundsWhatItWrites) {
  std::array<uint8_t, 8> bytes{};
  const SignalLayout layout{
      .start_bit = 8, .length_bits = 8, .type = RawType::kSigned, .scale = 0.1};
  insert_physical(layout, 1.26, bytes);
  EXPECT_EQ(raw_from(layout, bytes), 13);
  insert_physical(layout, 1e9, bytes);
  EXPECT_EQ(raw_from(layout, bytes), 127);
  insert_physical(layout, -1e9, bytes);
  EXPECT_EQ(raw_from(layout, bytes), -128);
  EXPECT_NEAR(highest_physical(layout), 12.7, 1e-12);
  EXPECT_NEAR(lowest_physical(layout), -12.8, 1e-12);
}

}  // namespace
}  // namespace bevloc::can
