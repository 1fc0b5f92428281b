#include "firmware/stages/gnss_lag_watch.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "common/se2.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

/// A vehicle on a winding road, with a yaw rate every 20 ms and GNSS every 100 ms by default.
class GnssLagWatchTest : public testing::Test {
 protected:
  void drive(double duration_s, double lag_s) {
    const double end_s = time_s_ + duration_s;
    for (; time_s_ < end_s; time_s_ += 0.01) {
      const auto step = std::lround(100.0 * time_s_);
      const Time now = Time(milliseconds(10 * step));
      // GNSS comes between two samples of odometry.
      if (step % gnss_steps_ == 1) watch_.add(gnss_at(now, lag_s));
      if (step % 2 == 0) watch_.add_rate(now, rate_radps(time_s_) + 0.002 * normal_(random_));
    }
  }

  static double rate_radps(double time_s) { return 0.3 * std::sin(0.5 * time_s); }
  static double heading_rad(double time_s) { return 0.6 * (1.0 - std::cos(0.5 * time_s)); }

  /// Its heading has an error of 1 degree that changes slowly, and noise.
  GnssSample gnss_at(Time now, double lag_s) {
    error_rad_ = 0.995 * error_rad_ + radians(0.1) * normal_(random_);
    GnssSample sample;
    sample.time = now;
    const double heading_noise_rad = error_rad_ + radians(0.3) * normal_(random_);
    sample.yaw = {wrap_angle(heading_rad(time_s_ - lag_s) + heading_noise_rad), heading_sigma_rad_};
    return sample;
  }

  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
  double error_rad_ = 0.0;
  double heading_sigma_rad_ = radians(1.0);
  double time_s_ = 0.0;
  int gnss_steps_ = 10;  ///< GNSS comes every so many steps of 10 ms
  GnssLagWatch watch_;
};

TEST_F(GnssLagWatchTest, GnssInTimeDoesNotContradict) {
  for (int minute = 0; minute < 60; ++minute) {
    drive(60.0, 0.05);
    ASSERT_FALSE(watch_.contradicts()) << "minute " << minute;
  }
  EXPECT_EQ(watch_.lag_ms(), 0);
}

TEST_F(GnssLagWatchTest, FindsHeadingsThatAreHalfASecondOld) {
  drive(30.0, 0.5);
  EXPECT_TRUE(watch_.contradicts());
  EXPECT_NEAR(watch_.lag_ms(), 500, 100);
}

TEST_F(GnssLagWatchTest, FindsOldHeadingsThatComeOften) {
  gnss_steps_ = 2;
  drive(30.0, 0.5);
  EXPECT_TRUE(watch_.contradicts());
}

TEST_F(GnssLagWatchTest, GnssThatIsInTimeAgainAgrees) {
  drive(60.0, 0.5);
  drive(120.0, 0.0);
  EXPECT_FALSE(watch_.contradicts());
}

TEST_F(GnssLagWatchTest, ForgetsWhatWasBeforeAReset) {
  drive(30.0, 0.5);
  watch_.reset();
  EXPECT_FALSE(watch_.contradicts());
  drive(60.0, 0.0);
  EXPECT_FALSE(watch_.contradicts());
}

TEST_F(GnssLagWatchTest, HeadingsAreStillOldAfterAGap) {
  drive(30.0, 0.5);
  ASSERT_TRUE(watch_.contradicts());
  watch_.note_gap();
  time_s_ += 10.0;
  EXPECT_TRUE(watch_.contradicts());
  EXPECT_NEAR(watch_.lag_ms(), 500, 100);
  drive(2.0, 0.5);
  EXPECT_TRUE(watch_.contradicts());
  drive(120.0, 0.0);
  EXPECT_FALSE(watch_.contradicts()) << "bends show that they are in time again";
}

/// The yaw rates before the gap say nothing about a heading after it.
TEST_F(GnssLagWatchTest, AGapBringsNoContradiction) {
  drive(30.0, 0.0);
  watch_.note_gap();
  EXPECT_FALSE(watch_.contradicts());
  time_s_ += 10.0;
  drive(60.0, 0.0);
  EXPECT_FALSE(watch_.contradicts());
}

TEST_F(GnssLagWatchTest, AHeadingThatSeemsNewerIsNoLag) {
  drive(60.0, -0.3);
  EXPECT_FALSE(watch_.contradicts());
  EXPECT_EQ(watch_.lag_ms(), 0);
}

/// While the monitor is not certain again, its estimates may have the other sign.
TEST_F(GnssLagWatchTest, AYawRateThatWasLateIsNoLagLater) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    random_.seed(seed);
    watch_.reset();
    time_s_ = error_rad_ = 0.0;
    drive(60.0, -0.3);
    EXPECT_FALSE(watch_.contradicts()) << "seed " << seed;
    for (int second = 0; second < 120; ++second) {
      drive(1.0, 0.0);
      EXPECT_FALSE(watch_.contradicts()) << "seed " << seed << ", second " << second;
    }
  }
}

TEST_F(GnssLagWatchTest, ACourseOverGroundSaysNothing) {
  heading_sigma_rad_ = radians(3.0);
  drive(60.0, 0.5);
  EXPECT_FALSE(watch_.contradicts());
}

}  // namespace
}  // namespace bevloc::firmware
