#include "pipeline/online_calibration/motion_direction.h"

#include <functional>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

bool none_is_missing(int) {
  return false;
}

/// Drives a bend with all cameras turned by `turn_rad`, and a frameset every `step_m`. Odometry
/// measures `bias_radps` too much, and is missing in every `gap`-th frameset. Framesets for which
/// `is_missing` is true are missing, and matches for which `is_unclear` is true are not clear.
/// Returns the turns that were found.
std::vector<double> drive(double turn_rad, double bias_radps, int gap = 1000,
                          const std::function<bool(int)>& is_missing = none_is_missing,
                          double step_m = 1.0, int framesets = 600,
                          const std::function<bool(int)>& is_unclear = none_is_missing) {
  MotionDirection direction;
  std::vector<double> turns;
  Se2 truth{120.0, -40.0, 2.9};
  constexpr double kPeriod_s = 0.1;
  for (int i = 1; i <= framesets; ++i) {
    const double yaw_rate_radps = 0.15;
    const Se2 half{0.5 * step_m, 0.0, 0.5 * kPeriod_s * yaw_rate_radps};
    truth = truth * half * half;
    const Se2 measured_half{0.5 * step_m, 0.0, 0.5 * kPeriod_s * (yaw_rate_radps + bias_radps)};
    if (is_missing(i)) continue;
    const auto time_of = [](int frameset) {
      return Time(std::chrono::milliseconds(100 * frameset));
    };
    std::optional<DrivenStep> step{{time_of(i - 1), time_of(i), measured_half * measured_half}};
    if (i % gap == 0) step.reset();
    std::optional<Se2> matched{{truth.x_m, truth.y_m, wrap_angle(truth.yaw_rad + turn_rad)}};
    if (is_unclear(i)) matched.reset();
    if (const auto turn = direction.add(matched, step)) turns.push_back(turn->turn_rad);
  }
  return turns;
}

TEST(MotionDirection, FindsTheTurnOfAllCamerasInABend) {
  for (const double turn_deg : {-1.0, 0.0, 1.0}) {
    const std::vector<double> turns = drive(radians(turn_deg), 0.0);
    ASSERT_EQ(turns.size(), 9U);
    for (const double turn : turns) EXPECT_NEAR(degrees(turn), turn_deg, 0.01);
  }
}

TEST(MotionDirection, BearsABiasOfTheYawRate) {
  const std::vector<double> turns = drive(0.0, radians(0.3));
  ASSERT_EQ(turns.size(), 9U);
  for (const double turn : turns) EXPECT_NEAR(degrees(turn), 0.0, 0.05);
}

TEST(MotionDirection, BeginsAgainWhereOdometryIsMissing) {
  EXPECT_TRUE(drive(radians(1.0), 0.0, 55).empty()) << "no stretch is long enough";
  const std::vector<double> turns = drive(radians(1.0), 0.0, 100);
  ASSERT_GE(turns.size(), 5U);
  for (const double turn : turns) EXPECT_NEAR(degrees(turn), 1.0, 0.01);
}

/// The stretches before and after missing framesets must not count as one stretch.
TEST(MotionDirection, BeginsAgainWhereFramesetsAreMissing) {
  const auto is_missing = [](int i) { return i % 100 >= 30 && i % 100 < 45; };
  const std::vector<double> turns = drive(0.0, 0.0, 1000, is_missing);
  EXPECT_GE(turns.size(), 5U);
  for (const double turn : turns) EXPECT_NEAR(degrees(turn), 0.0, 0.01);
}

/// Odometry turns away by 1.2 degrees while no match is clear. A comparison across that time would
/// take a part of this for a turn of all cameras.
TEST(MotionDirection, BeginsAgainAfterALongTimeWithoutClearMatches) {
  const auto is_unclear = [](int i) { return i > 15 && i <= 615; };
  const std::vector<double> turns =
      drive(0.0, radians(0.02), 10'000, none_is_missing, 1.0, 800, is_unclear);
  EXPECT_GE(turns.size(), 2U);
  for (const double turn : turns) EXPECT_NEAR(degrees(turn), 0.0, 0.1);
}

TEST(MotionDirection, BearsAShortTimeWithoutClearMatches) {
  const auto is_unclear = [](int i) { return i % 60 >= 30 && i % 60 < 60; };
  const std::vector<double> turns =
      drive(radians(1.0), 0.0, 10'000, none_is_missing, 1.0, 600, is_unclear);
  EXPECT_GE(turns.size(), 8U);
  for (const double turn : turns) EXPECT_NEAR(degrees(turn), 1.0, 0.01);
}

/// At 40 m/s and ten framesets a second, 60 m have only 15 framesets.
TEST(MotionDirection, AFastVehicleNeedsALongerStretch) {
  const std::vector<double> turns = drive(radians(1.0), 0.0, 1000, none_is_missing, 4.0);
  EXPECT_GE(turns.size(), 25U);
  for (const double turn : turns) EXPECT_NEAR(degrees(turn), 1.0, 0.01);
}

}  // namespace
}  // namespace bevloc
