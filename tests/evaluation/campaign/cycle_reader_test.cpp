#include "evaluation/campaign/cycle_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/publisher/pose_publisher.h"

namespace bevloc::evaluation {
namespace {

constexpr Time kDriveBegins{std::chrono::seconds(10)};
constexpr GeoOrigin kReaderOrigin{49.0, 8.4};
constexpr Se2 kTruePose{100.0, 50.0, 0.0};

class CycleReaderTest : public testing::Test {
 protected:
  /// Sends a pose that is so far ahead of the true one.
  void send(double ahead_m, Time now) {
    can::PoseReport report;
    report.status.state = HealthState::kTracking;
    report.capture_time = now;
    report.pose_time = now;
    report.map_from_vehicle = {kTruePose.x_m + ahead_m, kTruePose.y_m, kTruePose.yaw_rad};
    report.covariance = Eigen::Matrix3d::Identity() * 0.01;
    report.protection_level = {
        .longitudinal_m = 1.0, .lateral_m = 0.5, .yaw_rad = radians(0.8), .integrity_risk = 1e-5};
    publisher_.publish(report, now);
  }

  can::MockWire wire_;
  const std::unique_ptr<can::Bus> sender_ = wire_.connect();
  can::PosePublisher publisher_{
      *sender_, {.map_origin = {kReaderOrigin.latitude_deg, kReaderOrigin.longitude_deg}}};
  CycleReader reader_{wire_.connect(), can::BaseIds(), kReaderOrigin,
                      [](double) { return kTruePose; }, kDriveBegins};
};

TEST_F(CycleReaderTest, JudgesTheWorstPoseOfACycle) {
  Time now = kDriveBegins;
  for (const auto& [first_m, second_m] : {std::pair{5.0, 0.0}, {0.0, 5.0}, {-5.0, 1.0}}) {
    send(first_m, now);
    send(second_m, now + kSolutionCycle);
    now += 2 * kSolutionCycle;
    const JudgedCycle cycle = reader_.step(now);
    ASSERT_TRUE(cycle.pose);
    EXPECT_NEAR(std::abs(cycle.pose->error.x()), 5.0, 0.02) << first_m << ", " << second_m;
  }
  EXPECT_FALSE(reader_.step(now).pose) << "nothing was sent since";
}

TEST(MissingCyclesTest, AreThoseBetweenTwoCycles) {
  EXPECT_TRUE(missing_cycles_s(1.0, 1.01).empty());
  EXPECT_TRUE(missing_cycles_s(14.99, 15.0).empty());
  EXPECT_THAT(missing_cycles_s(14.99, 15.02), testing::ElementsAre(15.0, 15.01));
  EXPECT_EQ(missing_cycles_s(1.0, 4.0).size(), 299U);
}

}  // namespace
}  // namespace bevloc::evaluation
