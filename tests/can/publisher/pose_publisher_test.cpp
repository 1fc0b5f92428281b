#include "can/publisher/pose_publisher.h"

#include <cctype>
#include <chrono>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/can/publisher/pose_publisher_fixture.h"

namespace bevloc::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::kNow;
using test::kOrigin;
using test::PosePublisherTest;
using test::tracking_report;

TEST_F(PosePublisherTest, AConsumerWithTheDbcFileReadsTheReport) {
  publish(tracking_report(kNow), kNow);
  EXPECT_EQ(frames_.size(), 11u);
  EXPECT_EQ(value("LOC_Status", "State"), 2.0);
  EXPECT_EQ(value("LOC_Status", "CameraOk_FrontLeft"), 1.0);
  EXPECT_EQ(value("LOC_Status", "CameraOk_Front"), 0.0);
  EXPECT_EQ(value("LOC_Status", "CameraOk_BackRight"), 1.0);
  EXPECT_EQ(value("LOC_Status", "OdometryOk"), 1.0);
  EXPECT_EQ(value("LOC_Status", "GnssOk"), 0.0);
  EXPECT_EQ(value("LOC_Status", "MapOk"), 1.0);
  EXPECT_EQ(value("LOC_Status", "MapId"), 0xBEEF);
  EXPECT_NEAR(value("LOC_Time", "CaptureAge"), 83.0, 0.051);
  EXPECT_NEAR(value("LOC_PosLocal", "LocalEast"), 123.456, 0.0051);
  EXPECT_NEAR(value("LOC_PosLocal", "LocalNorth"), -78.9, 0.0051);
  EXPECT_NEAR(value("LOC_Attitude", "Heading"), 60.0, 0.02);
  EXPECT_NEAR(value("LOC_Velocity", "VelocityX"), 13.37, 0.0051);
  EXPECT_NEAR(value("LOC_Velocity", "YawRate"), -4.2, 0.0051);
  EXPECT_NEAR(value("LOC_Latitude", "StdDevNorth"), 0.1, 1e-9);
  EXPECT_NEAR(value("LOC_Longitude", "StdDevEast"), 0.2, 1e-9);
  EXPECT_NEAR(value("LOC_Correction", "DeltaLongitudinal"), 0.432, 1e-9);
  EXPECT_NEAR(value("LOC_Correction", "DeltaLateral"), -0.123, 1e-9);
  EXPECT_NEAR(value("LOC_Correction", "DeltaYaw"), 0.57, 1e-9);
  EXPECT_NEAR(value("LOC_Integrity", "ProtectionLongitudinal"), 1.24, 1e-9) << "rounded up";
  EXPECT_NEAR(value("LOC_Integrity", "ProtectionLateral"), 0.51, 1e-9) << "rounded up";
  EXPECT_NEAR(value("LOC_Integrity", "ProtectionYaw"), 1.45, 1e-9) << "rounded up";
  EXPECT_EQ(value("LOC_Integrity", "IntegrityRiskExponent"), 5.0);
}

TEST_F(PosePublisherTest, LatitudeAndLongitudeRoundTripTo1Cm) {
  GeoReference geo(kOrigin);
  PoseReport report = tracking_report(kNow);
  for (const double x_m : {-9000.0, -0.004, 25.5, 7777.77}) {
    report.map_from_vehicle = {x_m, 0.5 * x_m + 3.0, 0.3};
    publish(report, kNow);
    const Se2 back = geo.map_from_geodetic(
        {{value("LOC_Latitude", "Latitude"), value("LOC_Longitude", "Longitude")}, 0.0});
    EXPECT_NEAR(back.x_m, report.map_from_vehicle.x_m, 0.01);
    EXPECT_NEAR(back.y_m, report.map_from_vehicle.y_m, 0.01);
  }
}

TEST_F(PosePublisherTest, StandardDeviationsAreAlongTheVehiclesAxes) {
  PoseReport report = tracking_report(kNow);
  const double yaw_rad = radians(30.0);
  const Eigen::Vector2d along(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  report.covariance.topLeftCorner<2, 2>() =
      0.3 * 0.3 * along * along.transpose() + 0.05 * 0.05 * across * across.transpose();
  publish(report, kNow);
  EXPECT_NEAR(value("LOC_StdDev", "StdDevLongitudinal"), 0.30, 1e-9);
  EXPECT_NEAR(value("LOC_StdDev", "StdDevLateral"), 0.05, 1e-9);
  EXPECT_NEAR(value("LOC_StdDev", "StdDevHeading"), 0.58, 1e-9) << "0.573 degrees, rounded up";
}

/// "GNSS missing" and "GnssMissing" have the same.
std::string small_letters_of(std::string_view text) {
  std::string letters;
  for (const char c : text) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return letters;
}

TEST_F(PosePublisherTest, EachReasonHasItsFlag) {
  PoseReport report = tracking_report(kNow);
  for (int bit = 0; bit < kWhyCount; ++bit) {
    report.status.why = static_cast<Why>(1u << bit);
    publish(report, kNow);
    std::vector<std::string> flags;
    for (const char* message : {"LOC_Status", "LOC_Integrity"}) {
      for (const test::DbcSignal& signal : dbc_.message(message).signals) {
        if (signal.name.starts_with("Why_") && value(message, signal.name) != 0.0) {
          flags.push_back(small_letters_of(signal.name));
        }
      }
    }
    EXPECT_THAT(flags,
                testing::ElementsAre("why" + small_letters_of(to_string(report.status.why))));
  }
}

/// A reader adds CaptureTime and UtcOffset modulo 2^32 us. The date lies after 2038, when 32 bits
/// of seconds overflow.
TEST_F(PosePublisherTest, AReaderKnowsTheCaptureTimeInUtc) {
  constexpr Duration kIn2040 = seconds(2'224'540'800) + microseconds(123'456);
  with_clock_.emplace(*sender_, PosePublisherConfig{.map_origin = kOrigin, .sends_clock = true});
  PoseReport report = tracking_report(kNow);
  report.clock = {
      .source = TimeSource::kPtp, .utc_offset = kIn2040, .utc_error = microseconds(1234)};
  publish(report, kNow);
  const auto utc_us = static_cast<uint64_t>(value("LOC_Time", "CaptureTime")) +
                      static_cast<uint64_t>(value("LOC_Clock", "UtcOffset"));
  const auto expected =
      std::chrono::floor<microseconds>(report.capture_time->time_since_epoch() + kIn2040);
  EXPECT_EQ(static_cast<uint32_t>(utc_us), static_cast<uint32_t>(expected.count()));
  EXPECT_NEAR(value("LOC_Clock", "UtcError"), 1.24, 1e-9) << "rounded up";

  publish(report, kNow + milliseconds(10));
  EXPECT_FALSE(frames_.contains("LOC_Clock")) << "every 100 ms";
  report.clock.source = TimeSource::kFreeRunning;
  publish(report, kNow + milliseconds(100));
  EXPECT_TRUE(is_sna("LOC_Clock", "UtcError"));
  report.clock = {.source = TimeSource::kNtp, .utc_error = milliseconds(656)};
  publish(report, kNow + milliseconds(200));
  EXPECT_TRUE(is_sna("LOC_Clock", "UtcError")) << "beyond the range";
}

TEST_F(PosePublisherTest, CaptureTimeIsModulo32BitMicroseconds) {
  PoseReport report = tracking_report(kNow);
  report.capture_time = kNow - microseconds(1500);
  publish(report, kNow);
  EXPECT_EQ(value("LOC_Time", "CaptureTime"), 5000e6 - 1500.0 - 4294967296.0);
}

TEST_F(PosePublisherTest, FramesOfOneSolutionShareAnEpochAndCountersRise) {
  for (int cycle = 0; cycle < 40; ++cycle) {
    const Time now = kNow + milliseconds(10 * cycle);
    publish(tracking_report(now), now);
    for (const auto& [message, frame] : frames_) {
      EXPECT_EQ(value(message, "EPOCH"), cycle % 16) << message;
      if (message == "LOC_Status" || message == "LOC_Identity") continue;
      EXPECT_EQ(value(message, "COUNTER"), cycle % 16) << message;
    }
  }
}

TEST_F(PosePublisherTest, StatusIsSentOnItsCycleAndOnChange) {
  std::vector<int> cycles_with_status;
  for (int cycle = 0; cycle < 30; ++cycle) {
    const Time now = kNow + milliseconds(10 * cycle);
    PoseReport report = tracking_report(now);
    if (cycle >= 14) report.status.state = HealthState::kDegraded;
    publish(report, now);
    if (frames_.contains("LOC_Status")) cycles_with_status.push_back(cycle);
    EXPECT_EQ(frames_.size(),
              9u + frames_.contains("LOC_Status") + frames_.contains("LOC_Identity"));
  }
  EXPECT_EQ(cycles_with_status, (std::vector<int>{0, 10, 14, 24}));
}

TEST_F(PosePublisherTest, StatusKeepsItsCycleWhenCallsAreEarlyAndLate) {
  std::vector<int> cycles_with_status;
  for (int cycle = 0; cycle <= 40; ++cycle) {
    const milliseconds late(cycle % 20 == 0 ? 2 : -2);
    const Time now = kNow + milliseconds(10 * cycle) + late;
    publish(tracking_report(now), now);
    if (frames_.contains("LOC_Status")) cycles_with_status.push_back(cycle);
  }
  EXPECT_EQ(cycles_with_status, (std::vector<int>{0, 10, 20, 30, 40}));
}

TEST_F(PosePublisherTest, TheIdentityIsKnownAfterOneSecond) {
  const Identity identity{
      .program = 1, .configuration = 2, .model = 0xFFFFFFFF, .rig = 0x80000000, .map = 0xDEADBEEF};
  PosePublisher publisher(*sender_, {.map_origin = kOrigin, .identity = identity});
  const test::DbcMessage& message = dbc_.message("LOC_Identity");
  std::map<double, double> checksums;
  std::vector<int> cycles;
  for (int cycle = 0; cycle < 100; ++cycle) {
    const Time now = kNow + milliseconds(10 * cycle);
    publisher.publish(tracking_report(now), now);
    while (const auto received = reader_->receive()) {
      if (received->frame.id != message.id) continue;
      const auto payload = received->frame.payload();
      cycles.push_back(cycle);
      checksums[message.signal("IdentityItem").physical_from(payload)] =
          message.signal("IdentityChecksum").physical_from(payload);
    }
  }
  EXPECT_EQ(cycles, (std::vector<int>{0, 20, 40, 60, 80}));
  const std::map<double, double> wanted = {
      {0, 1}, {1, 2}, {2, 0xFFFFFFFF}, {3, 0x80000000}, {4, 0xDEADBEEF}};
  EXPECT_EQ(checksums, wanted);
}

TEST_F(PosePublisherTest, AStatusThatCouldNotBeSentIsSentAgain) {
  wire_.set_down(true);
  publish(tracking_report(kNow), kNow);
  EXPECT_TRUE(frames_.empty());
  wire_.set_down(false);
  publish(tracking_report(kNow), kNow + milliseconds(10));
  EXPECT_TRUE(frames_.contains("LOC_Status"));
}

}  // namespace
}  // namespace bevloc::can
