#include "can/messages/odometry_check.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/se2.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kWheelTrack_m = 1.6;
constexpr milliseconds kUsualInterval(20);

class OdometryCheckTest : public testing::Test {
 protected:
  using Wheels = OdometryCheck::Wheels;

  Wheels at(double speed_mps, double yaw_rate_radps) const {
    const double half_mps = 0.5 * kWheelTrack_m * yaw_rate_radps;
    return {now_, speed_mps - half_mps, speed_mps + half_mps, yaw_rate_radps};
  }

  OdometryVerdict judge(const Wheels& sample) {
    const OdometryVerdict verdict = check_.judge(sample);
    now_ += interval_;
    return verdict;
  }

  /// Returns the number of refused samples.
  int drive(double speed_mps, double yaw_rate_radps, Duration duration) {
    int refused = 0;
    for (const Time end = now_ + duration; now_ < end;) {
      refused += judge(at(speed_mps, yaw_rate_radps)) != OdometryVerdict::kPlausible;
    }
    return refused;
  }

  OdometryCheck check_{kWheelTrack_m, kUsualInterval};
  Duration interval_ = kUsualInterval;
  Time now_{seconds(100)};
};

TEST_F(OdometryCheckTest, WheelsThatContradictTheYawRateAreRefused) {
  const double kmh = 1.0 / 3.6;
  const Wheels bad[] = {{now_, -80 * kmh, 80 * kmh, 0.0},
                        {now_, 80 * kmh, -80 * kmh, 0.0},
                        {now_, 20 * kmh, 0.0, 0.0},
                        {now_, 0.0, 20 * kmh, 0.0},
                        {now_, 1.3 * 15.0, 15.0, 0.0}};
  for (const Wheels& sample : bad) {
    EXPECT_EQ(OdometryCheck(kWheelTrack_m, kUsualInterval).judge(sample),
              OdometryVerdict::kWheelsContradictYawRate)
        << sample.left_mps << " and " << sample.right_mps;
  }
}

TEST_F(OdometryCheckTest, ATurnThatNoVehicleMakesIsRefused) {
  const double fast_radps = radians(160.0);
  EXPECT_EQ(judge({now_, 15.0, 15.0, fast_radps}), OdometryVerdict::kTooSharp);
  EXPECT_EQ(judge(at(15.0, fast_radps)), OdometryVerdict::kTooSharp) << "the wheels agree";
  EXPECT_EQ(judge(at(0.0, 0.5)), OdometryVerdict::kTooSharp) << "no vehicle turns on the spot";
  EXPECT_EQ(check_.count(OdometryVerdict::kTooSharp), 3u);
}

TEST_F(OdometryCheckTest, TheHardestDrivingIsPlausible) {
  EXPECT_EQ(drive(0.0, 0.0, seconds(1)), 0);
  double speed_mps = 0.0;
  for (; speed_mps < 50.0; speed_mps += 0.02 * 8.0) {
    EXPECT_EQ(judge(at(speed_mps, 0.0)), OdometryVerdict::kPlausible) << speed_mps;
  }
  for (; speed_mps > 0.0; speed_mps -= 0.02 * 11.0) {
    EXPECT_EQ(judge(at(speed_mps, 0.0)), OdometryVerdict::kPlausible) << speed_mps;
  }
  for (int i = 0; i < 500; ++i) {
    const double yaw_rate_radps = 0.6 * std::sin(0.02 * i * 2.0);  // 0.9 g across, 1.2 rad/s^2
    EXPECT_EQ(judge(at(15.0 * std::min(1.0, i / 100.0), yaw_rate_radps * std::min(1.0, i / 100.0))),
              OdometryVerdict::kPlausible)
        << i;
  }
}

TEST_F(OdometryCheckTest, ATightTurnBackwardsIsPlausible) {
  for (int i = 0; i < 100; ++i) {
    const double speed_mps = -0.02 * i;
    EXPECT_EQ(judge(at(speed_mps, speed_mps / 3.5)), OdometryVerdict::kPlausible) << i;
  }
}

TEST_F(OdometryCheckTest, WornTyresAndAnotherTrackArePlausible) {
  for (const double speed_mps : {0.0, 10.0, 40.0}) {
    for (const double track_m : {1.35, 1.85}) {
      const double yaw_rate_radps =
          std::min(0.5, 8.0 / std::max(speed_mps, 1.0)) * std::min(1.0, speed_mps / 5.0);
      const double half_mps = 0.5 * track_m * yaw_rate_radps;
      EXPECT_EQ(OdometryCheck(kWheelTrack_m, kUsualInterval)
                    .judge({now_, 1.01 * (speed_mps - half_mps), 0.99 * (speed_mps + half_mps),
                            yaw_rate_radps}),
                OdometryVerdict::kPlausible)
          << speed_mps << " m/s, track " << track_m;
    }
  }
}

TEST_F(OdometryCheckTest, BothWheelsSpinningAreRefusedUntilTheyGrip) {
  EXPECT_EQ(drive(13.9, 0.0, seconds(2)), 0);
  EXPECT_EQ(drive(1.3 * 13.9, 0.0, seconds(2)), 100) << "spin of 2 s";
  EXPECT_EQ(drive(13.9, 0.0, seconds(2)), 0) << "used again from the first sample on";
  EXPECT_EQ(check_.count(OdometryVerdict::kSpeedJump), 100u);
}

TEST_F(OdometryCheckTest, WheelsThatGainSpeedWithinATenthOfASecondAreRefused) {
  for (const int interval_ms : {2, 5, 10, 20}) {
    interval_ = milliseconds(interval_ms);
    const int steps = 100 / interval_ms;
    for (const double speed_mps : {5.0, 10.0, 25.0}) {
      for (const double factor : {1.3, 0.3}) {
        check_ = OdometryCheck(kWheelTrack_m, kUsualInterval);
        EXPECT_EQ(drive(speed_mps, 0.0, seconds(2)), 0);
        for (int i = 1; i <= steps; ++i) {
          judge(at(speed_mps * std::lerp(1.0, factor, 1.0 * i / steps), 0.0));
        }
        EXPECT_EQ(drive(factor * speed_mps, 0.0, milliseconds(1500)), 1500 / interval_ms)
            << speed_mps << " m/s every " << interval_ms << " ms";
        EXPECT_EQ(drive(speed_mps, 0.0, seconds(1)), 0) << speed_mps;
      }
    }
  }
}

TEST_F(OdometryCheckTest, LockedWheelsAreRefused) {
  EXPECT_EQ(drive(13.9, 0.0, seconds(2)), 0);
  EXPECT_EQ(drive(0.3 * 13.9, 0.0, milliseconds(1500)), 75);
  EXPECT_EQ(drive(13.5, 0.0, seconds(2)), 0);
}

TEST_F(OdometryCheckTest, ANewLevelIsUsedAfterItHasSettled) {
  EXPECT_EQ(drive(10.0, 0.0, seconds(1)), 0);
  const int refused = drive(20.0, 0.0, seconds(5));
  EXPECT_NEAR(refused, 125, 2) << "2.5 s";
}

TEST_F(OdometryCheckTest, AfterAGapAnySpeedIsPlausible) {
  EXPECT_EQ(drive(12.0, 0.0, seconds(1)), 0);
  EXPECT_EQ(judge(at(6.0, 0.0)), OdometryVerdict::kSpeedJump);
  check_.note_gap();
  EXPECT_EQ(drive(6.0, 0.0, seconds(1)), 0);
  EXPECT_EQ(judge(at(12.0, 0.0)), OdometryVerdict::kSpeedJump) << "jumps after the gap count";
}

TEST_F(OdometryCheckTest, OneWildSampleIsRefusedAlone) {
  EXPECT_EQ(drive(10.0, 0.0, seconds(1)), 0);
  EXPECT_EQ(judge(at(60.0, 0.0)), OdometryVerdict::kSpeedJump);
  EXPECT_EQ(drive(10.0, 0.0, seconds(1)), 0);
  EXPECT_EQ(judge(at(10.0, 0.5)), OdometryVerdict::kYawRateJump);
  EXPECT_EQ(drive(10.0, 0.0, seconds(1)), 0);
}

TEST_F(OdometryCheckTest, ASlowRateIsNoticedWithHysteresis) {
  for (const int interval_ms : {60, 100, 180}) {
    OdometryCheck check{kWheelTrack_m, kUsualInterval};
    const auto run = [&](int every_ms, int samples) {
      int changes = 0;
      bool slow = check.is_slow();
      for (int i = 0; i < samples; ++i) {
        now_ += milliseconds(every_ms);
        check.judge({now_, 10.0, 10.0, 0.0});
        changes += slow != check.is_slow();
        slow = check.is_slow();
      }
      return changes;
    };
    EXPECT_EQ(run(20, 100), 0);
    EXPECT_FALSE(check.is_slow());
    EXPECT_EQ(run(interval_ms, 1000 / interval_ms), 1) << "within one second";
    EXPECT_TRUE(check.is_slow());
    EXPECT_EQ(run(interval_ms, 200), 0) << "without a flap";
    EXPECT_EQ(run(20, 50), 1);
    EXPECT_FALSE(check.is_slow());
  }
}

TEST_F(OdometryCheckTest, AFewLostSamplesAreNotSlow) {
  for (const int lost_ms : {120, 300, 5000}) {
    EXPECT_EQ(drive(10.0, 0.0, seconds(1)), 0);
    now_ += milliseconds(lost_ms);
    for (int i = 0; i < 50; ++i) {
      EXPECT_EQ(drive(10.0, 0.0, milliseconds(20)), 0);
      EXPECT_FALSE(check_.is_slow()) << lost_ms << " ms, sample " << i;
    }
  }
}

TEST_F(OdometryCheckTest, ASlowRateIsJudgedByTheRightInterval) {
  interval_ = milliseconds(40);
  check_ = OdometryCheck(kWheelTrack_m, interval_);
  EXPECT_EQ(drive(10.0, 0.0, seconds(2)), 0);
  now_ += 2 * interval_;
  drive(10.0, 0.0, interval_);
  EXPECT_FALSE(check_.is_slow()) << "two samples are lost";
  interval_ = milliseconds(120);
  drive(10.0, 0.0, seconds(3));
  EXPECT_TRUE(check_.is_slow());
  interval_ = milliseconds(40);
  drive(10.0, 0.0, seconds(2));
  EXPECT_FALSE(check_.is_slow());
}

TEST_F(OdometryCheckTest, OnlyWheelsOnBothSidesLean) {
  EXPECT_EQ(drive(14.0, 0.1, seconds(30)), 0);
  EXPECT_TRUE(check_.wheel_lean());
  Wheels one_side = at(14.0, 0.1);
  one_side.both_sides = false;
  EXPECT_EQ(judge(one_side), OdometryVerdict::kPlausible);
  EXPECT_FALSE(check_.wheel_lean());
}

TEST_F(OdometryCheckTest, AYawRateWithTheWrongSignIsRefusedInABend) {
  EXPECT_EQ(drive(10.0, 0.3, seconds(2)), 0);
  int plausible = 0;
  for (int i = 0; i < 50; ++i) {
    Wheels wrong = at(10.0, 0.3);
    wrong.yaw_rate_radps *= -1.0;
    plausible += judge(wrong) == OdometryVerdict::kPlausible ? 1 : 0;
  }
  EXPECT_LT(plausible, 20) << "samples of 20 ms";
}

}  // namespace
}  // namespace bevloc::can
