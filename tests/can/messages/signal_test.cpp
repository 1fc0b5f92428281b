#include "can/messages/signal.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "can/messages/encode_quantity.h"

namespace bevloc::can {
namespace {

constexpr Signal kSigned{.name = "s",
                         .start_bit = 16,
                         .length_bits = 12,
                         .is_signed = true,
                         .scale = 0.1,
                         .min = -204.7,
                         .max = 204.7,
                         .has_sna = true};
constexpr Signal kUnsigned{
    .name = "u", .start_bit = 28, .length_bits = 16, .scale = 0.01, .max = 359.99, .has_sna = true};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Frame full_frame(uint8_t fill) {
  Frame frame{.id = 1, .length = 8};
  frame.data.fill(fill);
  return frame;
}

TEST(Signal, EncodesTheNearestStep) {
  EXPECT_EQ(raw_from_physical(kSigned, 1.24), 12);
  EXPECT_EQ(raw_from_physical(kSigned, 1.26), 13);
  EXPECT_EQ(raw_from_physical(kSigned, -1.26), -13);
}

TEST(Signal, SaturatesAndNeverWraps) {
  EXPECT_EQ(raw_from_physical(kSigned, 1e30), 2047);
  EXPECT_EQ(raw_from_physical(kSigned, -1e30), -2047);
  EXPECT_EQ(raw_from_physical(kUnsigned, -0.02), 0);
  EXPECT_EQ(raw_from_physical(kUnsigned, 360.5), 35999);
}

TEST(Signal, AValueThatIsNotFiniteBecomesSna) {
  EXPECT_EQ(raw_from_physical(kSigned, std::nan("")), -2048);
  EXPECT_EQ(raw_from_physical(kSigned, kInfinity), -2048);
  EXPECT_EQ(raw_from_physical(kUnsigned, -kInfinity), 65535);
}

TEST(Signal, DecodesNeitherSnaNorReservedValues) {
  EXPECT_FALSE(physical_from_raw(kSigned, -2048));
  EXPECT_FALSE(physical_from_raw(kUnsigned, 65535));
  EXPECT_FALSE(physical_from_raw(kUnsigned, 36000));
  EXPECT_DOUBLE_EQ(*physical_from_raw(kUnsigned, 35999), 359.99);
}

TEST(Signal, ChangesOnlyItsOwnBits) {
  for (const uint8_t fill : {uint8_t{0x00}, uint8_t{0xFF}}) {
    Frame frame = full_frame(fill);
    insert_raw(frame, kUnsigned, 0x1234);
    EXPECT_EQ(extract_raw(frame, kUnsigned), 0x1234);
    insert_raw(frame, kUnsigned, fill == 0 ? 0 : 0xFFFF);
    EXPECT_EQ(frame, full_frame(fill));
  }
}

TEST(Signal, HasIntelByteOrder) {
  Frame frame = full_frame(0);
  insert_raw(frame, {.start_bit = 16, .length_bits = 24, .is_signed = true}, -2);
  EXPECT_EQ(frame.data, (std::array<uint8_t, kMaxFdLength>{0, 0, 0xFE, 0xFF, 0xFF, 0, 0, 0}));
}

TEST(Signal, MayLieAnywhereInAnFdFrame) {
  for (const int start_bit : {61, 301, 489}) {
    Frame frame{.id = 1, .length = 64, .data = {}, .format = FrameFormat::kFd};
    frame.data.fill(0xFF);
    const Signal signal{.start_bit = start_bit, .length_bits = 23, .is_signed = true};
    insert_raw(frame, signal, -0x123456);
    EXPECT_EQ(extract_raw(frame, signal), -0x123456);
    insert_raw(frame, signal, -1);
    for (const uint8_t byte : frame.data) EXPECT_EQ(byte, 0xFF);
  }
}

TEST(EncodeHeading, AFullTurnIsZero) {
  Frame frame = full_frame(0);
  encode_heading(frame, kUnsigned, 359.994);
  EXPECT_EQ(extract_raw(frame, kUnsigned), 35999);
  encode_heading(frame, kUnsigned, 359.996);
  EXPECT_EQ(extract_raw(frame, kUnsigned), 0);
  encode_heading(frame, kUnsigned, std::nan(""));
  EXPECT_EQ(extract_raw(frame, kUnsigned), 65535);
}

TEST(EncodeSigma, RoundsUp) {
  Frame frame = full_frame(0);
  encode_sigma(frame, kUnsigned, 0.0301);
  EXPECT_EQ(extract_raw(frame, kUnsigned), 4);
  encode_sigma(frame, kUnsigned, 0.03);
  EXPECT_EQ(extract_raw(frame, kUnsigned), 3);
  encode_sigma(frame, kUnsigned, 0.0);
  EXPECT_EQ(extract_raw(frame, kUnsigned), 0);
  encode_sigma(frame, kUnsigned, std::nan(""));
  EXPECT_EQ(extract_raw(frame, kUnsigned), 65535);
}

}  // namespace
}  // namespace bevloc::can
