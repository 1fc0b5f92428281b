#include "can/bus/send_gate.h"

#include <array>

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;

constexpr std::array<uint32_t, 2> kIds = {0x500, 0x501};
constexpr Time kStart(std::chrono::seconds(50));

TEST(SendGate, LetsOneFrameOfAnIdThroughUntilItIsConfirmed) {
  SendGate gate(kIds);
  EXPECT_TRUE(gate.enter(0x500, kStart));
  EXPECT_FALSE(gate.enter(0x500, kStart + milliseconds(10)));
  EXPECT_TRUE(gate.enter(0x501, kStart + milliseconds(10))) << "ids do not wait for each other";
  EXPECT_EQ(gate.confirm(0x500, kStart + milliseconds(12)), Duration(milliseconds(12)));
  EXPECT_TRUE(gate.enter(0x500, kStart + milliseconds(20)));
}

TEST(SendGate, AFrameThatTheKernelRefusedDoesNotBlock) {
  SendGate gate(kIds);
  EXPECT_TRUE(gate.enter(0x500, kStart));
  gate.leave(0x500);
  EXPECT_TRUE(gate.enter(0x500, kStart));
}

TEST(SendGate, AnUnexpectedEchoIsNotAConfirmation) {
  SendGate gate(kIds);
  EXPECT_FALSE(gate.confirm(0x500, kStart));
  EXPECT_FALSE(gate.confirm(0x123, kStart));
  EXPECT_TRUE(gate.enter(0x500, kStart));
  EXPECT_TRUE(gate.confirm(0x500, kStart));
  EXPECT_FALSE(gate.confirm(0x500, kStart));
}

TEST(SendGate, ALatencyIsNeverNegative) {
  SendGate gate(kIds);
  EXPECT_TRUE(gate.enter(0x500, kStart));
  EXPECT_EQ(gate.confirm(0x500, kStart - milliseconds(1)), Duration::zero());
}

TEST(SendGate, ALostFrameBlocksOnlyForALimitedTimeWhileTheBusIsAlive) {
  SendGate gate(kIds);
  EXPECT_TRUE(gate.enter(0x500, kStart));
  const Time later = kStart + SendGate::kGiveUp;
  gate.note_alive(later - Duration(1));
  EXPECT_FALSE(gate.enter(0x500, later));
  gate.note_alive(later);
  EXPECT_TRUE(gate.enter(0x500, later));
  EXPECT_FALSE(gate.enter(0x500, later)) << "still one frame at a time";
}

TEST(SendGate, ABusWithoutAcknowledgementCollectsOneFrameOfEachIdentifier) {
  SendGate gate(kIds);
  int entered = 0;
  for (Duration passed{}; passed < std::chrono::seconds(10); passed += milliseconds(10)) {
    for (const uint32_t id : kIds) entered += gate.enter(id, kStart + passed);
  }
  EXPECT_EQ(entered, 2);
  const Time returned = kStart + std::chrono::seconds(10);
  for (const uint32_t id : kIds) EXPECT_TRUE(gate.confirm(id, returned));
  for (const uint32_t id : kIds) EXPECT_TRUE(gate.enter(id, returned)) << "sending goes on";
}

TEST(SendGate, AStalledBusLetsNoOtherIdentifierEnter) {
  SendGate gate(kIds);
  EXPECT_TRUE(gate.enter(0x500, kStart));
  EXPECT_FALSE(gate.is_stalled(kStart + SendGate::kStall));
  const Time late = kStart + SendGate::kStall + Duration(1);
  EXPECT_TRUE(gate.is_stalled(late));
  EXPECT_FALSE(gate.enter(0x501, late)) << "it would be old when the bus returns";
  gate.note_alive(late);
  EXPECT_FALSE(gate.is_stalled(late)) << "a frame of low priority waits on a busy bus";
  EXPECT_TRUE(gate.enter(0x501, late));
  gate.reset();
  EXPECT_FALSE(gate.is_stalled(late + std::chrono::seconds(1)));
}

TEST(SendGate, AResetFreesAllPlaces) {
  SendGate gate(kIds);
  for (const uint32_t id : kIds) EXPECT_TRUE(gate.enter(id, kStart));
  gate.reset();
  for (const uint32_t id : kIds) EXPECT_TRUE(gate.enter(id, kStart));
}

TEST(SendGate, IdsWithoutConfirmationAlwaysPass) {
  SendGate gate({});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(gate.enter(0x500, kStart));
}

}  // namespace
}  // namespace bevloc::can
