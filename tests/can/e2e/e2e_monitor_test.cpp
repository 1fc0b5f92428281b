#include "can/e2e/e2e_monitor.h"

#include <gtest/gtest.h>

#include "tests/can/e2e/test_frames.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;

constexpr E2eProtection kProtection{.data_id = 0x42, .profile = E2eProfile::kP02};
constexpr Duration kCycle = milliseconds(20);
constexpr uint8_t kLength = 8;

/// One sender and one receiver of a message; the sender sends every cycle.
class E2eMonitorTest : public testing::Test {
 protected:
  /// The sender's next frame.
  Frame next() {
    Frame frame = test::frame_of(std::vector<uint8_t>(kLength));
    sender_.protect(frame);
    return frame;
  }

  /// The frame arrives one cycle after the previous one. Returns whether it can be used.
  bool arrives(const Frame& frame) {
    time_ += kCycle;
    return accept(frame, time_);
  }

  bool accept(const Frame& frame, Time received) {
    return monitor_.accept(e2e_frame_of(frame, kProtection, kLength), received);
  }

  void wait(int cycles) { time_ += cycles * kCycle; }

  /// Sends `frames` frames. Returns how many of them can be used.
  int send(int frames) {
    int used = 0;
    for (int i = 0; i < frames; ++i) used += arrives(next());
    return used;
  }

  void lose(int frames) {
    for (int i = 0; i < frames; ++i) next();
    wait(frames);
  }

  E2eSender sender_{kProtection};
  E2eMonitor monitor_{highest_counter(kProtection.profile), {.cycle = kCycle}};
  Time time_{};
};

TEST_F(E2eMonitorTest, UsesEachFrameOfOneSender) {
  EXPECT_EQ(send(40), 40);
  EXPECT_EQ(monitor_.state(), E2eState::kValid);
  EXPECT_EQ(monitor_.counters().ok, 40u);
  EXPECT_EQ(monitor_.counters().lost, 0u);
}

TEST_F(E2eMonitorTest, RefusesDamagedFramesAndCountsThem) {
  send(5);
  Frame damaged = next();
  test::flip(damaged, 30);
  EXPECT_FALSE(arrives(damaged));
  Frame cut = next();
  cut.length = kLength - 1;
  EXPECT_FALSE(arrives(cut));
  EXPECT_EQ(monitor_.counters().wrong_crc, 1u);
  EXPECT_EQ(monitor_.counters().wrong_length, 1u);
  EXPECT_EQ(send(5), 5);
  EXPECT_EQ(monitor_.counters().lost, 2u) << "the damaged frames are missing in the sequence";
}

TEST_F(E2eMonitorTest, RefusesARepeatedFrame) {
  send(5);
  const Frame frame = next();
  EXPECT_TRUE(arrives(frame));
  EXPECT_FALSE(arrives(frame));
  EXPECT_EQ(monitor_.counters().repeated, 1u);
}

TEST_F(E2eMonitorTest, ContinuesAfterLostFramesWithTheirCount) {
  send(5);
  lose(3);
  EXPECT_EQ(send(1), 1);
  EXPECT_EQ(monitor_.counters().lost, 3u);
  EXPECT_EQ(monitor_.counters().wrong_sequence, 0u);
}

TEST_F(E2eMonitorTest, RefusesACounterThatRisesFasterThanTime) {
  send(5);
  for (int i = 0; i < 3; ++i) next();
  EXPECT_FALSE(arrives(next()));
  EXPECT_EQ(monitor_.counters().wrong_sequence, 1u);
}

TEST_F(E2eMonitorTest, BecomesInvalidByManyDamagedFramesAndReturns) {
  send(5);
  for (int i = 0; i < 4; ++i) {
    Frame damaged = next();
    test::flip(damaged, 30);
    arrives(damaged);
  }
  EXPECT_EQ(monitor_.state(), E2eState::kInvalid);
  const uint64_t not_valid = monitor_.counters().not_valid;
  EXPECT_FALSE(arrives(next())) << "a good frame is not used before the message is valid again";
  EXPECT_EQ(monitor_.counters().not_valid, not_valid + 1);
  EXPECT_GT(send(20), 5);
  EXPECT_EQ(monitor_.state(), E2eState::kValid);
}

TEST_F(E2eMonitorTest, FollowsASenderThatBeganAgainAfterASilence) {
  send(5);
  wait(50);
  sender_ = E2eSender(kProtection);
  send(2);  // the counter 9 would continue the sequence; 0 does not
  EXPECT_GT(send(20), 10);
  EXPECT_EQ(monitor_.state(), E2eState::kValid);
}

TEST_F(E2eMonitorTest, RefusesASecondSenderAndKeepsTheFirst) {
  send(20);
  E2eSender forger(kProtection);
  int forged = 0;
  int used = 0;
  for (int i = 0; i < 20; ++i) {
    used += arrives(next());
    Frame frame = test::frame_of(std::vector<uint8_t>(kLength, 0xEE));
    forger.protect(frame);
    forged += accept(frame, time_ + kCycle / 2);
  }
  EXPECT_LE(forged, 1) << "at most where both counters meet";
  EXPECT_TRUE(monitor_.has_second_sender());
  EXPECT_EQ(used, 20) << "the frames of the first sender can still be used";
}

}  // namespace
}  // namespace bevloc::can
