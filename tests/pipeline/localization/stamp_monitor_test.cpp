#include "pipeline/localization/stamp_monitor.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "common/se2.h"

namespace bevloc {
namespace {

/// A vehicle that drives through bends, its odometry at 50 Hz and its matches at 10 Hz.
struct Ride {
  double bend_radps = 0.3;  ///< largest yaw rate; 0: a straight road
  double offset_s = 0.0;    ///< of the camera stamps
  double right_after_s = std::numeric_limits<double>::infinity();  ///< then the offset is 0
  double bias_radps = radians(0.1);
  double scale = 1.01;
  double heading_noise_rad = radians(0.12);
  double duration_s = 120.0;
  bool silent_in_bends = false;  ///< in each bend, odometry is missing for 1.5 s
  /// From this time in a bend, odometry repeats its yaw rate for 5 s, and there are no headings for
  /// 10 s.
  double stuck_after_s = std::numeric_limits<double>::infinity();
};

/// The time since the beginning of the latest bend. One begins every 12 s.
double since_bend_s(double time_s) {
  return std::fmod(time_s, 12.0);
}

/// Bends of 4 s to the left and to the right in turn.
double yaw_rate_at(const Ride& ride, double time_s) {
  const double in_bend_s = since_bend_s(time_s);
  const double side = std::fmod(time_s, 24.0) < 12.0 ? 1.0 : -1.0;
  return in_bend_s < 4.0 ? side * ride.bend_radps * std::pow(std::sin(M_PI * in_bend_s / 4.0), 2)
                         : 0.0;
}

/// Whether odometry sends no yaw rate.
bool is_silent_at(const Ride& ride, double time_s) {
  const double in_bend_s = since_bend_s(time_s);
  return ride.silent_in_bends && in_bend_s >= 1.0 && in_bend_s < 2.5;
}

StampMonitor after(const Ride& ride, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  StampMonitor monitor(std::chrono::milliseconds(30));
  double heading_rad = 3.0;  // crosses 180 degrees
  double correlated_rad = 0.0;
  std::vector<double> headings;  // every millisecond
  double rate_radps = 0.0;
  const int end_ms = static_cast<int>(1e3 * ride.duration_s);
  for (int ms = 0; ms < end_ms; ++ms) {
    const double time_s = 1e-3 * ms;
    heading_rad += 1e-3 * yaw_rate_at(ride, time_s);
    headings.push_back(heading_rad);
    if (ms % 20 == 0 && !is_silent_at(ride, time_s)) {
      if (time_s < ride.stuck_after_s || time_s > ride.stuck_after_s + 5.0) {
        rate_radps = ride.scale * yaw_rate_at(ride, time_s) + ride.bias_radps +
                     radians(0.1) * normal(random);
      }
      monitor.add_rate(Time(from_seconds(time_s)), rate_radps);
    }
    if (time_s > ride.stuck_after_s && time_s < ride.stuck_after_s + 10.0) continue;
    // The report of a match comes 180 ms after its stamp, so that an exposure may be 100 ms later.
    if (ms % 100 == 80 && ms > 1000) {
      correlated_rad = 0.9 * correlated_rad + 0.44 * ride.heading_noise_rad * normal(random);
      const int stamp_ms = ms - 180;
      const double offset_s = time_s < ride.right_after_s ? ride.offset_s : 0.0;
      const int exposed_ms = stamp_ms - static_cast<int>(1e3 * offset_s);
      monitor.add_heading(Time(std::chrono::milliseconds(stamp_ms)),
                          wrap_angle(headings[exposed_ms] + correlated_rad));
    }
  }
  return monitor;
}

TEST(StampMonitorTest, FindsTheOffsetOfTheStampsInBends) {
  for (const double offset_s : {-0.1, -0.05, 0.05, 0.1}) {
    const StampMonitor monitor = after({.offset_s = offset_s});
    const auto estimate = monitor.estimate();
    ASSERT_TRUE(estimate);
    EXPECT_NEAR(to_seconds(estimate->offset), offset_s, 0.012);
    EXPECT_TRUE(monitor.contradicts()) << offset_s;
  }
}

TEST(StampMonitorTest, AGapKeepsAWrongOffsetAndForgetsARightOne) {
  StampMonitor wrong = after({.offset_s = 0.1});
  wrong.note_gap();
  EXPECT_TRUE(wrong.contradicts());
  EXPECT_NEAR(wrong.contradicting_ms(), 100, 40);
  StampMonitor right = after({});
  ASSERT_TRUE(right.agrees());
  right.note_gap();
  EXPECT_FALSE(right.agrees());
}

TEST(StampMonitorTest, StampsThatAreRightAgainAfterTenMinutesAgreeWithinTwo) {
  const StampMonitor monitor =
      after({.offset_s = 0.1, .right_after_s = 600.0, .duration_s = 720.0});
  EXPECT_FALSE(monitor.contradicts());
  EXPECT_EQ(monitor.contradicting_ms(), 0);
}

TEST(StampMonitorTest, TellsTheOffsetWhileItContradicts) {
  for (double duration_s = 30.0; duration_s < 60.0; duration_s += 1.0) {
    const StampMonitor monitor = after({.offset_s = 0.1, .duration_s = duration_s});
    ASSERT_TRUE(monitor.contradicts()) << duration_s;
    ASSERT_TRUE(monitor.estimate()) << duration_s;
    EXPECT_NEAR(to_seconds(monitor.estimate()->offset), 0.1, 0.04) << duration_s;
    EXPECT_NEAR(monitor.contradicting_ms(), 100, 40) << duration_s;
  }
}

TEST(StampMonitorTest, AcceptsRightStampsWithUsualErrorsOfTheSensors) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const double bias_degps : {-0.3, 0.3}) {
      const StampMonitor monitor =
          after({.bias_radps = radians(bias_degps), .scale = 1.03, .duration_s = 60.0}, seed);
      EXPECT_FALSE(monitor.contradicts()) << "seed " << seed;
      ASSERT_TRUE(monitor.estimate());
      EXPECT_NEAR(to_seconds(monitor.estimate()->offset), 0.0, 0.03) << "seed " << seed;
    }
  }
}

TEST(StampMonitorTest, AStraightRoadSaysNothing) {
  const StampMonitor monitor = after({.bend_radps = 0.0, .offset_s = 0.1});
  EXPECT_FALSE(monitor.estimate());
  EXPECT_FALSE(monitor.contradicts());
}

/// The yaw rates on both sides of a gap do not tell how far the vehicle turned in it. A monitor
/// that integrates across the gaps of this ride finds an offset of -0.08 s.
TEST(StampMonitorTest, AGapOfTheRatesBeginsAnew) {
  const StampMonitor monitor = after({.silent_in_bends = true});
  ASSERT_TRUE(monitor.estimate());
  EXPECT_NEAR(to_seconds(monitor.estimate()->offset), 0.0, 0.03);
  EXPECT_FALSE(monitor.contradicts());
}

/// The repeated yaw rates turn by almost 1 rad more than the vehicle.
TEST(StampMonitorTest, HeadingsFarApartAreNotCompared) {
  const StampMonitor monitor = after({.duration_s = 216.0, .stuck_after_s = 25.5});
  EXPECT_TRUE(monitor.agrees());
}

}  // namespace
}  // namespace bevloc
