#include "pipeline/tracker/motion_model.h"

#include <cmath>
#include <random>
#include <utility>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace bevloc {
namespace {

/// A step without samples, in which the vehicle begins to turn.
TEST(MotionModelTest, ALongStepCoversABend) {
  constexpr double kSpeed_mps = 25.0;
  constexpr int kDrives = 4000;
  for (const double duration_s : {0.2, 0.5, 1.0}) {
    MotionNoise noise;
    noise.lateral_m_per_sqrt_m = 1e-4;
    noise.yaw_rad_per_sqrt_s = 1e-5;
    FilterState state;
    state.covariance.setZero();
    predict({kSpeed_mps, 0.0}, duration_s, noise, {}, state);
    const Eigen::Matrix2d covariance =
        state.covariance.block<2, 2>(FilterState::kY, FilterState::kY);
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    Eigen::Matrix2d seen = Eigen::Matrix2d::Zero();
    for (int i = 0; i < kDrives; ++i) {
      const double acceleration_radps2 = noise.yaw_acceleration_radps2 * normal(random);
      constexpr int kSteps = 100;
      Se2 pose;
      for (int k = 0; k < kSteps; ++k) {
        const double step_s = duration_s / kSteps;
        pose = pose * arc_motion(kSpeed_mps, acceleration_radps2 * (k + 0.5) * step_s, step_s);
      }
      const Eigen::Vector2d moved(pose.y_m, pose.yaw_rad);
      seen += moved * moved.transpose() / kDrives;
    }
    for (const auto& [row, col] : {std::pair(0, 0), {0, 1}, {1, 1}}) {
      EXPECT_NEAR(covariance(row, col) / seen(row, col), 1.0, 0.1)
          << duration_s << ": " << row << ", " << col;
    }
    EXPECT_EQ(covariance.llt().info(), Eigen::Success);
  }
}

/// How far the heading sigma grows in a step in which the vehicle stands at both ends.
double yaw_sigma_after(double duration_s) {
  FilterState state;
  state.covariance.setZero();
  predict({0.0, radians(0.3)}, duration_s, {}, {}, state);
  EXPECT_EQ(state.map_from_vehicle.yaw_rad, 0.0);
  return std::sqrt(state.covariance(FilterState::kYaw, FilterState::kYaw));
}

TEST(MotionModelTest, AVehicleMayTurnInALongStepBetweenTwoStandstills) {
  EXPECT_EQ(yaw_sigma_after(0.02), 0.0);
  EXPECT_EQ(yaw_sigma_after(kLongestStandstillStep_s), 0.0);
  EXPECT_GT(yaw_sigma_after(2.0 * kLongestStandstillStep_s), radians(5.0));
}

TEST(MotionModelTest, AVehicleWithAKnownBiasOfTheYawRateStands) {
  FilterState state;
  EXPECT_FALSE(state.stands({0.0, radians(0.8)}));
  state.yaw_rate_bias_radps = radians(0.6);
  EXPECT_TRUE(state.stands({0.0, radians(0.8)}));
  EXPECT_EQ(state.yaw_rate_radps({0.0, radians(0.8)}), 0.0);
  EXPECT_FALSE(state.stands({0.2, radians(0.8)}));
}

}  // namespace
}  // namespace bevloc
