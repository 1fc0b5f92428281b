#include "can/e2e/e2e.h"

#include <gtest/gtest.h>

#include "can/e2e/e2e_p02.h"
#include "can/messages/message_table.h"
#include "tests/can/e2e/test_frames.h"

namespace bevloc::can {
namespace {

using test::frame_of;

TEST(E2e, NoMessageIsAcceptedAsAnother) {
  for (const Message* sent : kMessages) {
    for (const Message* expected : kMessages) {
      if (sent == expected) continue;
      Frame frame = blank_frame(*sent, BaseIds{});
      E2eSender(sent->protection()).protect(frame);
      EXPECT_EQ(E2eChecker(sent->protection(), frame.length).check(frame), E2eResult::kOk);
      E2eChecker checker(expected->protection(), frame.length);
      EXPECT_EQ(checker.check(frame), E2eResult::kWrongCrc) << sent->name << expected->name;
    }
  }
}

TEST(E2eSender, P05CountsModulo256AndTheCheckerFollows) {
  const E2eProtection protection{0x1234, E2eProfile::kP05};
  E2eSender sender(protection);
  E2eChecker checker(protection, 8);
  for (int i = 0; i < 600; ++i) {
    Frame frame = frame_of({0, 0, 0, 1, 2, 3, 4, 5});
    sender.protect(frame);
    EXPECT_EQ(frame.data[2], i % 256);
    if (i % 200 == 199) continue;
    EXPECT_EQ(checker.check(frame), i % 200 == 0 && i > 0 ? E2eResult::kSomeLost : E2eResult::kOk);
  }
  EXPECT_EQ(checker.counters().lost, 2u);
}

TEST(E2eSender, CountsModulo16AndTheCheckerFollows) {
  E2eSender sender({0x42});
  E2eChecker checker({0x42}, 4);
  for (int i = 0; i < 40; ++i) {
    Frame frame = frame_of({0, 0, 1, 2});
    sender.protect(frame);
    EXPECT_EQ(frame.data[1], i % 16);
    EXPECT_EQ(checker.check(frame), E2eResult::kOk);
  }
  EXPECT_EQ(checker.counters().ok, 40u);
  EXPECT_EQ(checker.counters().lost, 0u);
}

TEST(E2eChecker, DetectsRepetition) {
  E2eChecker checker({0x42}, 4);
  Frame frame = frame_of({0, 0, 1, 2});
  protect_p02(frame, 0x42, 9);
  EXPECT_EQ(checker.check(frame), E2eResult::kOk);
  EXPECT_EQ(checker.check(frame), E2eResult::kRepeated);
  EXPECT_EQ(checker.counters().repeated, 1u);
}

TEST(E2eChecker, CountsLossAcrossTheWrapOfTheCounter) {
  E2eChecker checker({0x42}, 4);
  Frame frame = frame_of({0, 0, 1, 2});
  protect_p02(frame, 0x42, 14);
  EXPECT_EQ(checker.check(frame), E2eResult::kOk);
  protect_p02(frame, 0x42, 1);
  EXPECT_EQ(checker.check(frame), E2eResult::kSomeLost);
  EXPECT_EQ(checker.counters().lost, 2u);
  EXPECT_EQ(checker.counters().ok, 2u);
}

TEST(E2eChecker, WrongFramesDoNotMoveTheCounter) {
  E2eChecker checker({0x42}, 4);
  Frame frame = frame_of({0, 0, 1, 2});
  protect_p02(frame, 0x42, 3);
  EXPECT_EQ(checker.check(frame), E2eResult::kOk);

  Frame damaged = frame;
  protect_p02(damaged, 0x42, 9);
  damaged.data[3] ^= 0x10;
  EXPECT_EQ(checker.check(damaged), E2eResult::kWrongCrc);
  Frame shorter = frame_of({0, 0, 1});
  protect_p02(shorter, 0x42, 4);
  EXPECT_EQ(checker.check(shorter), E2eResult::kWrongLength);
  EXPECT_EQ(checker.check(Frame{}), E2eResult::kWrongLength);

  protect_p02(frame, 0x42, 4);
  EXPECT_EQ(checker.check(frame), E2eResult::kOk);
  EXPECT_EQ(checker.counters().wrong_crc, 1u);
  EXPECT_EQ(checker.counters().wrong_length, 2u);
}

}  // namespace
}  // namespace bevloc::can
