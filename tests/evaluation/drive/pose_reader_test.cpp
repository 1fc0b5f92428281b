#include "evaluation/drive/pose_reader.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/publisher/pose_publisher.h"
#include "tests/support/pose_matchers.h"

namespace bevloc::evaluation {
namespace {

using std::chrono::milliseconds;

constexpr can::GeodeticPosition kOrigin{49.0, 8.4};

can::PoseReport valid_report(Time now) {
  can::PoseReport report;
  report.status.state = HealthState::kTracking;
  report.capture_time = now - milliseconds(60);
  report.pose_time = now;
  report.map_from_vehicle = {123.4, -56.7, 2.5};
  report.covariance = Eigen::Matrix3d::Identity() * 0.01;
  report.protection_level = {
      .longitudinal_m = 1.0, .lateral_m = 0.5, .yaw_rad = radians(0.8), .integrity_risk = 1e-5};
  report.forward_speed_mps = 10.0;
  report.yaw_rate_radps = 0.1;
  return report;
}

void expect_protection(const can::ProtectionLevel& level) {
  EXPECT_NEAR(level.longitudinal_m, 1.0, 1e-9);
  EXPECT_NEAR(level.lateral_m, 0.5, 1e-9);
  EXPECT_NEAR(level.yaw_rad, radians(0.8), 1e-9);
  EXPECT_NEAR(level.integrity_risk, 1e-5, 1e-12);
}

class PoseReaderTest : public testing::Test {
 protected:
  std::optional<BusPose> send_and_read(const can::PoseReport& report, Time now) {
    publisher_.publish(report, now);
    std::optional<BusPose> pose;
    while (auto received = receiver_->receive()) {
      if (corrupt_) received->frame.data[3] ^= 1;
      if (const auto read = reader_.accept(*received)) pose = read;
    }
    return pose;
  }

  can::MockWire wire_;
  std::unique_ptr<can::Bus> sender_ = wire_.connect();
  std::unique_ptr<can::Bus> receiver_ = wire_.connect();
  can::PosePublisher publisher_{*sender_, {.map_origin = kOrigin}};
  PoseReader reader_{{}, kOrigin};
  bool corrupt_ = false;
};

TEST_F(PoseReaderTest, ReadsAPublishedPose) {
  const Time now(milliseconds(1000));
  const auto pose = send_and_read(valid_report(now), now);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->received, now);
  EXPECT_THAT(pose->map_from_vehicle, test::PoseNear({123.4, -56.7, 2.5}, 0.006, radians(0.01)));
  expect_protection(pose->protection_level);
  EXPECT_EQ(reader_.state(), HealthState::kTracking);
}

TEST_F(PoseReaderTest, ReadsTheFdVariant) {
  const Time now(milliseconds(1000));
  can::PosePublisher fd(*sender_, {.map_origin = kOrigin, .format = can::FrameFormat::kFd});
  fd.publish(valid_report(now), now);
  const auto received = receiver_->receive();
  ASSERT_TRUE(received);
  const auto pose = reader_.accept(*received);
  ASSERT_TRUE(pose);
  EXPECT_THAT(pose->map_from_vehicle, test::PoseNear({123.4, -56.7, 2.5}, 0.006, radians(0.01)));
  expect_protection(pose->protection_level);
  EXPECT_EQ(reader_.state(), HealthState::kTracking);
  EXPECT_FALSE(reader_.accept(*received)) << "the same frame again";
}

TEST_F(PoseReaderTest, IgnoresAnInvalidPose) {
  const Time now(milliseconds(1000));
  can::PoseReport report = valid_report(now);
  report.status.state = HealthState::kLost;
  EXPECT_FALSE(send_and_read(report, now));
  EXPECT_EQ(reader_.state(), HealthState::kLost);
}

TEST_F(PoseReaderTest, ReadsAnUnknownProtectionLevel) {
  const Time now(milliseconds(1000));
  can::PoseReport report = valid_report(now);
  report.protection_level = {};
  const auto pose = send_and_read(report, now);
  ASSERT_TRUE(pose);
  EXPECT_TRUE(std::isnan(pose->protection_level.lateral_m));
  EXPECT_TRUE(std::isnan(pose->protection_level.integrity_risk));
}

TEST_F(PoseReaderTest, ReadsTheReasonsOfBothVariants) {
  EXPECT_EQ(reader_.why(), WhyMask());
  const Time now(milliseconds(1000));
  can::PoseReport report = valid_report(now);
  report.status.why = Why::kCameraMissing | Why::kInternalFault | Why::kGnssContradicts;
  send_and_read(report, now);
  EXPECT_EQ(reader_.why(), report.status.why);

  report.status.why = Why::kForeignSender;
  can::PosePublisher fd(*sender_, {.map_origin = kOrigin, .format = can::FrameFormat::kFd});
  fd.publish(report, now);
  const auto received = receiver_->receive();
  ASSERT_TRUE(received);
  reader_.accept(*received);
  EXPECT_EQ(reader_.why(), WhyMask(Why::kForeignSender));
}

TEST_F(PoseReaderTest, IgnoresCorruptFrames) {
  const Time now(milliseconds(1000));
  corrupt_ = true;
  EXPECT_FALSE(send_and_read(valid_report(now), now));
  EXPECT_EQ(reader_.state(), HealthState::kInit);
}

}  // namespace
}  // namespace bevloc::evaluation
