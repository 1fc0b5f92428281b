// Faults of GNSS and odometry.
#include <vector>

#include <gtest/gtest.h>

#include "sim/faults/fault_table.h"
#include "sim/faults/gnss_faults.h"
#include "sim/faults/odometry_faults.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {
namespace {

constexpr double kTrack_m = 1.6;

class VehicleFaults : public testing::Test {
 protected:
  const World world_ = generate_world(2002);
  const Drive drive_{world_, 2002, 30.0};
  const GnssSimulator gnss_{drive_, 5};
  const OdometrySimulator odometry_{drive_, 5};

  GnssReading gnss(const Fault& fault, size_t index) const {
    const auto reading = reading_with_faults(gnss_, index, std::vector{fault}, drive_);
    EXPECT_TRUE(reading);
    return reading.value_or(GnssReading());
  }

  /// The GNSS error in directions of the map, with minus without the fault, at 10 s.
  Eigen::Vector2d gnss_offset(const Fault& fault, double time_s = 10.0) const {
    const auto index = static_cast<size_t>(std::lround(10.0 * time_s));
    return gnss(fault, index).position_m - gnss_.reading(index).position_m;
  }

  /// An index while the vehicle drives.
  size_t driving_index() const {
    for (size_t index = 200; index + 1 < odometry_.count(); ++index) {
      if (odometry_.reading(index).speed_mps > 5.0) return index;
    }
    ADD_FAILURE() << "the vehicle never drives";
    return 0;
  }

  WheelReading odometry(const Fault& fault, size_t index) const {
    const auto reading = reading_with_faults(odometry_, index, kTrack_m, std::vector{fault});
    EXPECT_TRUE(reading);
    return reading.value_or(WheelReading());
  }
  WheelReading healthy(size_t index) const {
    return reading_with_faults(odometry_, index, kTrack_m, {}).value();
  }
  double speed(const WheelReading& reading) const {
    return 0.5 * (reading.left_mps + reading.right_mps);
  }
};

TEST_F(VehicleFaults, WithoutAFaultNothingChanges) {
  const GnssReading good = gnss_.reading(17);
  const auto same = reading_with_faults(gnss_, 17, {}, drive_);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->position_m, good.position_m);
  EXPECT_EQ(same->heading_rad, good.heading_rad);
  EXPECT_TRUE(same->has_heading);
  const WheelReading wheels = healthy(300);
  const OdometryReading sensed = odometry_.reading(300);
  EXPECT_NEAR(speed(wheels), sensed.speed_mps, 1e-12);
  EXPECT_EQ(wheels.yaw_rate_radps, sensed.yaw_rate_radps);
  EXPECT_NEAR(wheels.right_mps - wheels.left_mps,
              kTrack_m * sensed.path_yaw_rate_radps + sensed.wheel_excess_mps, 1e-12)
      << "the wheels follow the path, not the measured yaw rate";
}

TEST_F(VehicleFaults, GnssJumpsInDirectionsOfTheMapAndOfTheVehicle) {
  Fault jump = make_fault(FaultKind::kGnssJump, 5.0);
  jump.amounts.east_m = 20.0;
  EXPECT_NEAR((gnss_offset(jump) - Eigen::Vector2d(20.0, 0.0)).norm(), 0.0, 1e-9);
  jump.amounts.east_m = 0.0;
  jump.amounts.across_m = 3.0;
  const double yaw = drive_.at(10.0).map_from_vehicle.yaw_rad;
  const Eigen::Vector2d left(-std::sin(yaw), std::cos(yaw));
  EXPECT_NEAR((gnss_offset(jump) - 3.0 * left).norm(), 0.0, 1e-9);
}

TEST_F(VehicleFaults, GnssRampGrowsAndASpoofIsPulledInAndStays) {
  Fault ramp = make_fault(FaultKind::kGnssRamp, 4.0);
  ramp.amounts.north_mps = 0.5;
  EXPECT_NEAR(gnss_offset(ramp, 10.0).y(), 3.0, 1e-9);
  EXPECT_NEAR(gnss_offset(ramp, 12.0).y(), 4.0, 1e-9);
  Fault spoof = make_fault(FaultKind::kGnssSpoof, 5.0);
  spoof.amounts.east_m = 20.0;
  spoof.amounts.pull_s = 8.0;
  EXPECT_NEAR(gnss_offset(spoof, 5.0).x(), 0.0, 1e-9);
  EXPECT_NEAR(gnss_offset(spoof, 9.0).x(), 10.0, 1e-9);
  EXPECT_NEAR(gnss_offset(spoof, 13.0).x(), 20.0, 1e-9);
  EXPECT_NEAR(gnss_offset(spoof, 25.0).x(), 20.0, 1e-9);
}

TEST_F(VehicleFaults, ASpoofAcrossTheVehicleKeepsItsFirstDirection) {
  Fault spoof = make_fault(FaultKind::kGnssSpoof, 5.0);
  spoof.amounts.across_m = 20.0;
  EXPECT_NEAR((gnss_offset(spoof, 15.0) - gnss_offset(spoof, 28.0)).norm(), 0.0, 1e-9);
}

TEST_F(VehicleFaults, GnssSigmaNoiseHeadingAndOutage) {
  const GnssReading good = gnss_.reading(100);
  const Se2 truth = drive_.at(good.time_s).map_from_vehicle;
  Fault sigma = make_fault(FaultKind::kGnssWrongSigma);
  sigma.amounts.factor = 0.1;
  const GnssReading sure = gnss(sigma, 100);
  EXPECT_DOUBLE_EQ(sure.position_sigma_m, 0.1 * good.position_sigma_m);
  EXPECT_DOUBLE_EQ(sure.heading_sigma_rad, 0.1 * good.heading_sigma_rad);
  EXPECT_EQ(sure.position_m, good.position_m);
  Fault noise = make_fault(FaultKind::kGnssNoise);
  noise.amounts.factor = 3.0;
  const GnssReading noisy = gnss(noise, 100);
  EXPECT_NEAR((noisy.position_m - truth.translation()).norm(),
              3.0 * (good.position_m - truth.translation()).norm(), 1e-9);
  EXPECT_EQ(noisy.position_sigma_m, good.position_sigma_m);
  EXPECT_FALSE(gnss(make_fault(FaultKind::kGnssNoHeading), 100).has_heading);
  EXPECT_FALSE(
      reading_with_faults(gnss_, 100, std::vector{make_fault(FaultKind::kGnssOutage)}, drive_));
}

TEST_F(VehicleFaults, StuckGnssRepeatsTheFixOfItsFirstMoment) {
  const Fault stuck = make_fault(FaultKind::kGnssStuck, 10.05);
  for (const size_t later : {101, 200}) {
    EXPECT_EQ(gnss(stuck, later).position_m, gnss_.reading(100).position_m);
    EXPECT_EQ(gnss(stuck, later).heading_rad, gnss_.reading(100).heading_rad);
  }
}

TEST_F(VehicleFaults, LateGnssSendsTheFixesOfSomeTimeAgo) {
  Fault late = make_fault(FaultKind::kGnssLate);
  late.amounts.delay_ms = 500.0;
  EXPECT_EQ(gnss(late, 200).position_m, gnss_.reading(195).position_m);
  EXPECT_EQ(gnss(late, 2).position_m, gnss_.reading(0).position_m) << "nothing older is there";
}

TEST_F(VehicleFaults, StuckOdometryRepeatsTheValuesOfItsFirstMoment) {
  const size_t index = driving_index();
  const Fault stuck =
      make_fault(FaultKind::kOdometryStuck, static_cast<double>(index) * 0.02 + 0.005);
  for (const size_t later : {index + 1, index + 100}) {
    EXPECT_EQ(odometry(stuck, later).left_mps, healthy(index).left_mps);
    EXPECT_EQ(odometry(stuck, later).yaw_rate_radps, healthy(index).yaw_rate_radps);
  }
  EXPECT_NE(healthy(index + 100).left_mps, healthy(index).left_mps);
}

TEST_F(VehicleFaults, LateOdometrySendsTheValuesOfSomeTimeAgo) {
  const size_t index = driving_index() + 50;
  Fault late = make_fault(FaultKind::kOdometryLate);
  late.amounts.delay_ms = 200.0;
  EXPECT_EQ(odometry(late, index).left_mps, healthy(index - 10).left_mps);
  EXPECT_EQ(odometry(late, index).yaw_rate_radps, healthy(index - 10).yaw_rate_radps);
  EXPECT_NE(healthy(index).yaw_rate_radps, healthy(index - 10).yaw_rate_radps);
}

TEST_F(VehicleFaults, WheelsSlipLockScaleAndReverse) {
  const size_t index = driving_index() + 50;
  const double began_s = static_cast<double>(index) * 0.02 - 0.5;
  const WheelReading good = healthy(index);
  const std::vector<std::pair<FaultKind, double>> factors = {{FaultKind::kOdometrySlip, 1.3},
                                                             {FaultKind::kOdometryLock, 0.3},
                                                             {FaultKind::kOdometryReversed, -1.0}};
  for (const auto& [kind, factor] : factors) {
    const WheelReading bad = odometry(make_fault(kind, began_s), index);
    EXPECT_NEAR(bad.left_mps, factor * good.left_mps, 1e-12) << info_of(kind).name;
    EXPECT_NEAR(bad.right_mps, factor * good.right_mps, 1e-12) << info_of(kind).name;
    EXPECT_EQ(bad.yaw_rate_radps, good.yaw_rate_radps) << info_of(kind).name;
  }
  Fault scaled = make_fault(FaultKind::kOdometryScaled, began_s);
  scaled.amounts.factor = 1.02;
  EXPECT_NEAR(speed(odometry(scaled, index)), 1.02 * speed(good), 1e-12);
  const double half_way_s = static_cast<double>(index) * 0.02 - 0.05;
  EXPECT_NEAR(speed(odometry(make_fault(FaultKind::kOdometrySlip, half_way_s), index)),
              1.15 * speed(good), 1e-9);
}

TEST_F(VehicleFaults, WheelsAndYawRateCanContradictEachOther) {
  Fault wheels = make_fault(FaultKind::kOdometryWheels);
  wheels.amounts.left_mps = 22.0;
  wheels.amounts.right_mps = -22.0;
  EXPECT_EQ(odometry(wheels, 400).left_mps, 22.0);
  EXPECT_EQ(odometry(wheels, 400).right_mps, -22.0);
  const WheelReading good = healthy(400);
  Fault bias = make_fault(FaultKind::kYawRateBias);
  bias.amounts.bias_degps = 3.0;
  EXPECT_NEAR(odometry(bias, 400).yaw_rate_radps - good.yaw_rate_radps, radians(3.0), 1e-12);
  EXPECT_EQ(odometry(bias, 400).left_mps, good.left_mps);
  Fault wrong = make_fault(FaultKind::kYawRateWrong);
  wrong.amounts.yaw_rate_degps = 160.0;
  EXPECT_DOUBLE_EQ(odometry(wrong, 400).yaw_rate_radps, radians(160.0));
  Fault scaled = make_fault(FaultKind::kYawRateScaled);
  scaled.amounts.factor = -1.0;
  EXPECT_DOUBLE_EQ(odometry(scaled, 400).yaw_rate_radps, -good.yaw_rate_radps);
}

TEST_F(VehicleFaults, FrontWheelsShowTheTrueMotionAndSpinWithTheRearOnes) {
  const size_t index = driving_index();
  const OdometryReading sensed = odometry_.reading(index);
  const WheelReading good = healthy(index);
  EXPECT_EQ(good.front_speed_mps, sensed.speed_mps);
  EXPECT_EQ(good.front_yaw_rate_radps, sensed.path_yaw_rate_radps);
  Fault wrong = make_fault(FaultKind::kYawRateWrong);
  wrong.amounts.yaw_rate_degps = 160.0;
  Fault wheels = make_fault(FaultKind::kOdometryWheels);
  wheels.amounts.left_mps = 22.0;
  for (const Fault& fault : {wrong, wheels}) {
    const WheelReading bad = odometry(fault, index);
    EXPECT_EQ(bad.front_speed_mps, good.front_speed_mps) << info_of(fault.kind).name;
    EXPECT_EQ(bad.front_yaw_rate_radps, good.front_yaw_rate_radps) << info_of(fault.kind).name;
  }
  Fault scaled = make_fault(FaultKind::kOdometryScaled);
  scaled.amounts.factor = 1.5;
  EXPECT_DOUBLE_EQ(odometry(scaled, index).front_speed_mps, 1.5 * good.front_speed_mps);
  EXPECT_DOUBLE_EQ(odometry(scaled, index).front_yaw_rate_radps, 1.5 * good.front_yaw_rate_radps);
}

TEST_F(VehicleFaults, SlowOdometryIsSentOncePerPeriodAndMissingOdometryNever) {
  const auto sent = [&](const Fault& fault) {
    int count = 0;
    for (size_t index = 0; index < 500; ++index) {
      if (reading_with_faults(odometry_, index, kTrack_m, std::vector{fault})) ++count;
    }
    return count;
  };
  Fault slow = make_fault(FaultKind::kOdometrySlow);
  for (const double period_ms : {20.0, 60.0, 100.0, 180.0}) {
    slow.amounts.period_ms = period_ms;
    EXPECT_NEAR(sent(slow), 10'000.0 / period_ms, 1.0) << period_ms;
  }
  EXPECT_EQ(sent(make_fault(FaultKind::kOdometryMissing)), 0);
}

}  // namespace
}  // namespace bevloc::sim
