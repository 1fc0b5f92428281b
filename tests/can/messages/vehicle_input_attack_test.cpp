// Frames of the vehicle that are forged, replayed, lost or late, all with a right CRC.
#include <deque>
#include <vector>

#include <gtest/gtest.h>

#include "can/e2e/e2e_p02.h"
#include "can/messages/vehicle_encoder.h"
#include "can/messages/vehicle_input.h"
#include "tests/can/messages/tracking_report.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using test::kNow;
using test::kOrigin;

constexpr milliseconds kOdometryCycle(kOdometryCycleMs);

/// A vehicle that drives at 10 m/s, and an input that listens to it and to others.
class VehicleInputAttackTest : public testing::Test {
 protected:
  using Pair = std::array<Frame, 2>;

  Pair honest() { return encoder_.odometry({.speed_mps = 10.0, .yaw_rate_radps = 0.05}); }

  /// Returns whether the frames gave a sample.
  bool feed(const Pair& frames, Time now) {
    bool sampled = false;
    for (const Frame& frame : frames) sampled |= bool{input_.accept({frame, now})};
    return sampled;
  }

  int drive(int cycles) {
    int samples = 0;
    for (int i = 0; i < cycles; ++i) {
      samples += feed(honest(), now_);
      now_ += kOdometryCycle;
    }
    return samples;
  }

  WhyMask why() const { return input_.fault_times().why(now_); }

  VehicleEncoder encoder_{BaseIds{}, kOrigin, 1.6};
  VehicleInput input_{BaseIds{}, kOrigin, 1.6};
  Time now_ = kNow;
};

/// Frames with a right CRC whose counter jumps by `step`.
class Forger {
 public:
  Forger(uint8_t counter, uint8_t step) : counter_(counter), step_(step) {}

  std::array<Frame, 2> next() {
    counter_ = static_cast<uint8_t>((counter_ + step_) & 0x0F);
    std::array<Frame, 2> frames = encoder_.odometry({.speed_mps = 10.5, .yaw_rate_radps = 0.05});
    const Message* messages[] = {&veh_wheel_speed::kMessage, &veh_yaw_rate::kMessage};
    for (size_t i = 0; i < frames.size(); ++i) {
      insert_raw(frames[i], kEpoch, counter_);
      protect_p02(frames[i], static_cast<uint8_t>(messages[i]->data_id), counter_);
    }
    return frames;
  }

 private:
  VehicleEncoder encoder_{BaseIds{}, kOrigin, 1.6};
  uint8_t counter_;
  uint8_t step_;
};

TEST_F(VehicleInputAttackTest, AnUndisturbedVehicleIsUsedFromTheFirstFrame) {
  EXPECT_EQ(drive(100), 100);
}

TEST_F(VehicleInputAttackTest, ForgedFramesThatReplaceTheVehicleAreRefused) {
  drive(50);
  Forger forger(1, 5);  // the vehicle's last counter was 1
  int accepted = 0;
  for (int i = 0; i < 200; ++i) accepted += feed(forger.next(), now_ + i * kOdometryCycle);
  EXPECT_EQ(accepted, 0);
}

TEST_F(VehicleInputAttackTest, ForgedFramesBesideTheVehicleAreRefusedAndTheVehicleIsUsed) {
  for (const int start : {0, 3, 9, 14}) {
    drive(50);
    Forger forger(static_cast<uint8_t>(start), 5);
    int forged = 0;
    int honest_samples = 0;
    for (int i = 0; i < 200; ++i) {
      honest_samples += feed(honest(), now_);
      forged += feed(forger.next(), now_ + kOdometryCycle / 2);
      now_ += kOdometryCycle;
    }
    EXPECT_LE(forged, 12) << "one in 16 has the next counter by chance; start " << start;
    EXPECT_GE(honest_samples, 188);
  }
}

TEST_F(VehicleInputAttackTest, AReplayBesideTheVehicleIsRefused) {
  for (int offset = 0; offset < 16; ++offset) {
    std::vector<Pair> recorded;
    for (int i = 0; i < 80; ++i) {
      recorded.push_back(honest());
      feed(recorded.back(), now_);
      now_ += kOdometryCycle;
    }
    drive(offset);
    int replayed = 0;
    for (const Pair& frames : recorded) {
      feed(honest(), now_);
      replayed += feed(frames, now_ + kOdometryCycle / 2);
      now_ += kOdometryCycle;
    }
    EXPECT_LE(replayed, 4) << "of 80, replayed " << offset << " frames later";
    now_ += std::chrono::seconds(1);
    drive(50);
  }
}

TEST_F(VehicleInputAttackTest, ASenderThatStartsAgainIsUsedSoon) {
  for (int restart = 1; restart < 16; ++restart) {
    drive(30 + restart);
    now_ += milliseconds(restart);
    encoder_ = VehicleEncoder(BaseIds{}, kOrigin, 1.6);
    const int samples = drive(50);
    EXPECT_GE(samples, 44) << "after " << restart;
  }
}

TEST_F(VehicleInputAttackTest, LostFramesDoNotStopTheUse) {
  drive(20);
  for (int lost = 1; lost <= 7; ++lost) {
    for (int i = 0; i < lost; ++i) honest();
    now_ += lost * kOdometryCycle;
    EXPECT_TRUE(feed(honest(), now_)) << lost << " frames lost";
    now_ += kOdometryCycle;
    EXPECT_EQ(drive(20), 20);
  }
}

TEST_F(VehicleInputAttackTest, LateFramesInOneBurstAreUsed) {
  drive(20);
  std::deque<Pair> late;
  for (int i = 0; i < 5; ++i) late.push_back(honest());
  now_ += 5 * kOdometryCycle;
  int samples = 0;
  for (const Pair& frames : late) samples += feed(frames, now_);
  EXPECT_EQ(samples, 5);
  EXPECT_EQ(drive(20), 20);
}

TEST_F(VehicleInputAttackTest, OdometryThatComesFarTooSeldomIsNotUsed) {
  drive(50);
  int samples = 0;
  for (int i = 0; i < 50; ++i) {
    now_ += milliseconds(220);
    samples += feed(honest(), now_);
  }
  EXPECT_LE(samples, 1) << "11 cycles without a frame make the message invalid";
  EXPECT_GE(drive(50), 45) << "it is used again when it is on time";
}

TEST_F(VehicleInputAttackTest, ASecondSenderIsNamed) {
  drive(50);
  EXPECT_EQ(why(), WhyMask());
  Forger forger(9, 5);
  for (int i = 0; i < 20; ++i) {
    feed(honest(), now_);
    feed(forger.next(), now_ + kOdometryCycle / 2);
    now_ += kOdometryCycle;
  }
  EXPECT_TRUE(why().has(Why::kForeignSender));
  drive(100);
  EXPECT_EQ(why(), WhyMask()) << "2 s later";
}

TEST_F(VehicleInputAttackTest, ARestartOfTheVehiclesSenderIsNoSecondSender) {
  for (int restart = 1; restart < 16; ++restart) {
    drive(30 + restart);
    encoder_ = VehicleEncoder(BaseIds{}, kOrigin, 1.6);
    for (int i = 0; i < 20; ++i) {
      drive(1);
      EXPECT_FALSE(why().has(Why::kForeignSender)) << restart << ", cycle " << i;
    }
  }
}

TEST_F(VehicleInputAttackTest, AFrameWithAnIdentifierOfTheLocalizerIsNamed) {
  drive(10);
  input_.accept({{.id = 0x7FF, .length = 8}, now_});
  EXPECT_EQ(why(), WhyMask()) << "somebody else's message";
  for (const Message* message : kMessages) {
    if (message->sender != Sender::kLocalizer) continue;
    input_.accept({blank_frame(*message, BaseIds{}), now_});
    EXPECT_EQ(why(), WhyMask(Why::kForeignSender)) << message->name;
    drive(60);
    EXPECT_EQ(why(), WhyMask()) << "1.2 s later";
  }
  EXPECT_EQ(input_.counters().foreign, 1u);
}

TEST_F(VehicleInputAttackTest, ImplausibleOdometryIsRefusedCountedAndNamed) {
  drive(50);
  const auto wheels = encoder_.odometry({.speed_mps = 10.0, .yaw_rate_radps = 2.8});
  EXPECT_FALSE(feed(wheels, now_));
  EXPECT_EQ(input_.counters().sharp_turns, 1u);
  EXPECT_EQ(why(), WhyMask(Why::kOdometryImplausible));
  now_ += kOdometryCycle;
  EXPECT_EQ(drive(60), 60);
  EXPECT_EQ(why(), WhyMask());
}

TEST_F(VehicleInputAttackTest, AFaultIsNotToldAnyMoreWhenAllMessagesStop) {
  drive(50);
  feed(encoder_.odometry({.speed_mps = 10.0, .yaw_rate_radps = 2.8}), now_);
  now_ += milliseconds(900);
  EXPECT_EQ(why(), WhyMask(Why::kOdometryImplausible));
  now_ += milliseconds(200);
  EXPECT_EQ(why(), WhyMask());
}

TEST_F(VehicleInputAttackTest, SlowOdometryIsNamedWithoutAFlap) {
  for (const int interval_ms : {60, 100, 180, 220}) {
    drive(100);
    EXPECT_EQ(why(), WhyMask());
    for (int i = 0; i < 200; ++i) {
      feed(honest(), now_);
      now_ += milliseconds(interval_ms);
      if (i * interval_ms < 1000) continue;
      EXPECT_EQ(why(), WhyMask(Why::kOdometryImplausible)) << interval_ms << ", " << i;
    }
    drive(100);
  }
}

}  // namespace
}  // namespace bevloc::can
