#include "pipeline/tracker/start_heading.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

constexpr double kStep_s = 0.02;
constexpr double kBiasSigma_radps = radians(0.3);

/// Drives along a bend with GNSS positions, and says when the heading is known.
class StartHeadingTest : public testing::Test {
 protected:
  void start_at(double yaw_rad) {
    map_from_vehicle_ = {1000.0, -500.0, yaw_rad};
    found_.reset();
    start_heading_.reset();
  }

  /// Returns whether the heading was found.
  bool drive(double duration_s, double speed_mps, double yaw_rate_radps) {
    for (double end_s = time_s_ + duration_s; time_s_ < end_s && !found_; time_s_ += kStep_s) {
      start_heading_.add(OdometrySample{at_s(time_s_), speed_mps, yaw_rate_radps});
      if (++steps_ % 5 == 0) {
        const Eigen::Vector2d noise(normal_(random_), normal_(random_));
        found_ = start_heading_.add(at_s(time_s_),
                                    map_from_vehicle_.translation() + sigma_m_ * noise, sigma_m_);
      }
      if (!found_) {
        map_from_vehicle_ = map_from_vehicle_ * arc_motion(speed_mps, yaw_rate_radps, kStep_s);
      }
    }
    return found_.has_value();
  }

  double error_in_sigmas() const {
    return std::abs(wrap_angle(found_->yaw_rad - map_from_vehicle_.yaw_rad)) / found_->sigma_rad;
  }

  StartHeading start_heading_{kBiasSigma_radps};
  std::optional<GnssSample::Yaw> found_;
  Se2 map_from_vehicle_;
  double sigma_m_ = 1.0;
  double time_s_ = 0.0;
  int steps_ = 0;
  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
};

TEST_F(StartHeadingTest, FindsEveryHeadingForwardsAndBackwards) {
  for (int yaw_deg = -180; yaw_deg < 180; yaw_deg += 15) {
    for (const double speed_mps : {12.0, 2.0, -2.0}) {
      start_at(radians(yaw_deg));
      ASSERT_TRUE(drive(20.0, speed_mps, 0.1)) << yaw_deg << ", " << speed_mps;
      EXPECT_LT(error_in_sigmas(), 4.0) << yaw_deg << ", " << speed_mps;
      EXPECT_LE(found_->sigma_rad, StartHeading::kLargestSigma_rad);
    }
  }
}

TEST_F(StartHeadingTest, NeedsALongerWayWithALargerSigma) {
  for (const double sigma_m : {1.0, 3.0}) {
    sigma_m_ = sigma_m;
    start_at(1.0);
    EXPECT_FALSE(drive(9.0 * sigma_m / 10.0, 10.0, 0.0)) << "9 m at 1 m of sigma";
    EXPECT_TRUE(drive(0.3 * sigma_m, 10.0, 0.0));
  }
}

TEST_F(StartHeadingTest, AStandingVehicleHasNone) {
  start_at(1.0);
  EXPECT_FALSE(drive(120.0, 0.0, 0.0));
  EXPECT_TRUE(drive(5.0, 5.0, 0.0)) << "however long it stood";
  EXPECT_LT(error_in_sigmas(), 4.0);
}

TEST_F(StartHeadingTest, AJumpOfGnssIsNoWay) {
  start_at(1.0);
  EXPECT_FALSE(drive(0.5, 10.0, 0.0));
  map_from_vehicle_.x_m += 100.0;
  ASSERT_TRUE(drive(5.0, 10.0, 0.0));
  EXPECT_LT(error_in_sigmas(), 4.0);
}

/// The heading of GNSS may be missing or too uncertain.
TEST(TrackerStart, WithoutAHeadingThePoseWaitsForTheWay) {
  for (int yaw_deg = 0; yaw_deg < 360; yaw_deg += 30) {
    for (const bool has_yaw : {false, true}) {
      std::mt19937 random(static_cast<unsigned>(yaw_deg));
      std::normal_distribution<double> normal;
      // The error of GNSS is as in the simulator.
      CorrelatedError east(0.97, 40.0);
      CorrelatedError north(0.97, 40.0);
      Tracker tracker;
      Se2 truth{0.0, 0.0, wrap_angle(radians(yaw_deg))};
      int waited = 0;
      for (int i = 0; i < 1500; ++i) {
        const double time_s = i * kStep_s;
        const Time now = at_s(time_s);
        tracker.add_odometry({now, 10.0, 0.05});
        if (i % 5 == 0) {
          GnssSample gnss{.time = now,
                          .east_m = truth.x_m + east.next(time_s, random) + 0.25 * normal(random),
                          .north_m = truth.y_m + north.next(time_s, random) + 0.25 * normal(random),
                          .sigma_east_m = 1.0,
                          .sigma_north_m = 1.0};
          if (has_yaw) gnss.yaw = {truth.yaw_rad + 0.5 * normal(random), 0.5};
          waited += tracker.add_gnss(gnss) == TrackerUpdate::kNoHeading ? 1 : 0;
        }
        if (const auto pose = tracker.pose_at(now)) {
          const double error_rad = wrap_angle(pose->map_from_vehicle.yaw_rad - truth.yaw_rad);
          ASSERT_LT(std::abs(error_rad), 4.0 * std::sqrt(pose->covariance(2, 2)))
              << yaw_deg << " degrees, step " << i;
        }
        truth = truth * arc_motion(10.0, 0.05, kStep_s);
      }
      EXPECT_TRUE(tracker.is_initialised());
      EXPECT_GT(waited, 8) << "less than 8 m";
      EXPECT_LT(waited, 16);
    }
  }
}

}  // namespace
}  // namespace bevloc
