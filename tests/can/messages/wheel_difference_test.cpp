#include "can/messages/wheel_difference.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "common/se2.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kNominalTrack_m = 1.6;

class WheelDifferenceTest : public testing::Test {
 protected:
  /// Drives in bends, with the errors below. Returns the number of contradicting samples.
  int drive(double speed_mps, Duration duration) {
    int contradicting = 0;
    for (const Time end = now_ + duration; now_ < end; now_ += milliseconds(20)) {
      const double turned_radps = 0.2 * std::sin(0.5 * to_seconds(now_.time_since_epoch()));
      const double yaw_rate_radps = sign_ * turned_radps + bias_radps_;
      const double wheels_mps =
          true_track_m_ * turned_radps + radius_share_ * speed_mps + 0.06 * normal_(random_);
      contradicting += difference_.contradicts(
          {now_, wheels_mps - kNominalTrack_m * yaw_rate_radps, speed_mps, yaw_rate_radps});
    }
    return contradicting;
  }

  WheelDifference difference_;
  Time now_{seconds(100)};
  double true_track_m_ = kNominalTrack_m;
  double radius_share_ = 0.0;
  double bias_radps_ = 0.0;
  double sign_ = 1.0;
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
};

TEST_F(WheelDifferenceTest, NoiseContradictsAtNoSpeed) {
  for (const double speed_mps : {0.0, 3.0, 12.0, 35.0, 0.0, 8.0}) {
    EXPECT_EQ(drive(speed_mps, seconds(600)), 0) << speed_mps << " m/s";
  }
}

TEST_F(WheelDifferenceTest, WornTyresAnotherTrackAndAZeroErrorAreLearned) {
  radius_share_ = 0.02;
  true_track_m_ = 1.7;
  bias_radps_ = radians(0.5);
  for (const double speed_mps : {5.0, 15.0, 30.0, 2.0}) {
    EXPECT_EQ(drive(speed_mps, seconds(60)), 0) << speed_mps << " m/s";
  }
}

TEST_F(WheelDifferenceTest, ABiasOf3DegreesPerSecondIsFoundWithinASecond) {
  radius_share_ = -0.01;
  for (const double speed_mps : {3.0, 14.0}) {
    bias_radps_ = 0.0;
    drive(speed_mps, seconds(30));
    bias_radps_ = radians(3.0);
    drive(speed_mps, milliseconds(1000));
    EXPECT_GT(drive(speed_mps, seconds(1)), 48) << speed_mps << " m/s, of 50 samples";
    bias_radps_ = 0.0;
    drive(speed_mps, seconds(2));
    EXPECT_EQ(drive(speed_mps, seconds(5)), 0) << speed_mps << " m/s, healed";
  }
}

TEST_F(WheelDifferenceTest, TheLeanHasUnitVarianceAtMost) {
  for (const double speed_mps : {3.0, 14.0}) {
    drive(speed_mps, seconds(60));
    double sum = 0.0;
    constexpr int kDraws = 300;
    for (int i = 0; i < kDraws; ++i) {
      drive(speed_mps, seconds(4));
      ASSERT_TRUE(difference_.lean());
      sum += *difference_.lean() * *difference_.lean();
    }
    EXPECT_LT(std::sqrt(sum / kDraws), 1.1) << speed_mps << " m/s";
    EXPECT_GT(std::sqrt(sum / kDraws), 0.3) << speed_mps << " m/s";
  }
}

TEST_F(WheelDifferenceTest, TheLeanIsUnknownBeforeTheWheelsAreLearned) {
  drive(14.0, milliseconds(500));
  EXPECT_FALSE(difference_.lean());
  drive(14.0, seconds(60));
  EXPECT_TRUE(difference_.lean());
}

TEST_F(WheelDifferenceTest, TheLeanReachesTwoSigmasSoonAfterABiasOf1DegreePerSecond) {
  for (const double sign : {-1.0, 1.0}) {
    double sum = 0.0;
    constexpr int kFaults = 20;
    for (int i = 0; i < kFaults; ++i) {
      bias_radps_ = 0.0;
      drive(14.0, seconds(60));
      bias_radps_ = sign * radians(1.0);
      drive(14.0, milliseconds(1500));
      ASSERT_TRUE(difference_.lean());
      sum += sign * *difference_.lean();
    }
    EXPECT_LT(sum / kFaults, -2.0);
  }
}

TEST_F(WheelDifferenceTest, AYawRateOfTheWrongSignIsFoundInTheFirstBend) {
  drive(10.0, seconds(30));
  sign_ = -1.0;
  EXPECT_GT(drive(10.0, seconds(6)), 200) << "of 300 samples";
}

TEST_F(WheelDifferenceTest, AChangeThatLastsIsLearnedAfterAMinute) {
  drive(10.0, seconds(30));
  bias_radps_ = radians(5.0);
  EXPECT_GT(drive(10.0, seconds(59)), 2900);
  drive(10.0, seconds(4));
  EXPECT_EQ(drive(10.0, seconds(10)), 0);
}

}  // namespace
}  // namespace bevloc::can
