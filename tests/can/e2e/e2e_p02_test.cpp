#include "can/e2e/e2e_p02.h"

#include <string_view>

#include <gtest/gtest.h>

#include "can/e2e/e2e.h"
#include "can/messages/message_table.h"
#include "tests/can/e2e/test_frames.h"

namespace bevloc::can {
namespace {

using test::flip;
using test::frame_of;

Frame protected_frame(const can::Message& message, uint8_t counter) {
  Frame frame = blank_frame(message, BaseIds{});
  for (size_t i = 1; i < frame.length; ++i) frame.data[i] ^= static_cast<uint8_t>(37 * i);
  protect_p02(frame, static_cast<uint8_t>(message.data_id), counter);
  return frame;
}

bool is_rejected(const Frame& frame, const can::Message& message) {
  return !is_usable(E2eChecker(message.protection(), message.length).check(frame));
}

TEST(Crc8H2f, HasThePublishedCheckValue) {
  constexpr std::string_view kText = "123456789";
  EXPECT_EQ(crc8_h2f({reinterpret_cast<const uint8_t*>(kText.data()), kText.size()}), 0xDF);
}

TEST(E2eP02, ReproducesPublishedVectors) {
  // The vectors of github.com/zariiii9003/autosar-e2e, test/test_p02.py.
  Frame zeros = frame_of({0, 0, 0, 0, 0, 0, 0, 0});
  protect_p02(zeros, 0, 1);
  EXPECT_EQ(zeros, frame_of({0x45, 0x01, 0, 0, 0, 0, 0, 0}));

  Frame rising = frame_of({0, 1, 2, 3, 4, 5, 6, 7});
  protect_p02(rising, 2, 2);
  EXPECT_EQ(rising, frame_of({0xBC, 0x02, 2, 3, 4, 5, 6, 7}));

  rising = frame_of({0, 1, 2, 3, 4, 5, 6, 7});
  protect_p02(rising, 1, 1);
  EXPECT_EQ(rising, frame_of({0x61, 0x01, 2, 3, 4, 5, 6, 7}));
}

TEST(E2eP02, ProtectKeepsTheHighNibbleOfByte1) {
  Frame frame = frame_of({0, 0xA5, 1, 2});
  protect_p02(frame, 7, 0x0C);
  EXPECT_EQ(frame.data[1], 0xAC);
}

TEST(E2eP02, EverySmallErrorInEveryMessageIsRejected) {
  for (const can::Message* message : kMessages) {
    if (message->format != FrameFormat::kClassic) continue;
    SCOPED_TRACE(message->name);
    const Frame intact = protected_frame(*message, 5);
    ASSERT_FALSE(is_rejected(intact, *message));
    const int bits = 8 * intact.length;
    int undetected = 0;
    for (int a = 0; a < bits; ++a) {
      Frame one = intact;
      flip(one, a);
      undetected += !is_rejected(one, *message);
      for (int b = a + 1; b < bits; ++b) {
        Frame two = one;
        flip(two, b);
        undetected += !is_rejected(two, *message);
        for (int c = b + 1; c < bits; ++c) {
          Frame three = two;
          flip(three, c);
          undetected += !is_rejected(three, *message);
        }
      }
    }
    EXPECT_EQ(undetected, 0);
  }
}

}  // namespace
}  // namespace bevloc::can
