#include <algorithm>
#include <chrono>
#include <limits>
#include <random>

#include "can/publisher/pose_publisher.h"
#include "tests/can/publisher/pose_publisher_fixture.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::kNan;
using test::kNow;
using test::PosePublisherTest;
using test::tracking_report;

TEST_F(PosePublisherTest, AProtectionLevelOutOfRangeIsNotAvailable) {
  PoseReport report = tracking_report(kNow);
  report.protection_level = {
      .longitudinal_m = 40.941, .lateral_m = 20.46, .yaw_rad = -0.1, .integrity_risk = 3e-6};
  publish(report, kNow);
  EXPECT_TRUE(is_sna("LOC_Integrity", "ProtectionLongitudinal"));
  EXPECT_NEAR(value("LOC_Integrity", "ProtectionLateral"), 20.46, 1e-9) << "the largest value";
  EXPECT_TRUE(is_sna("LOC_Integrity", "ProtectionYaw")) << "no bound is negative";
  EXPECT_EQ(value("LOC_Integrity", "IntegrityRiskExponent"), 5.0) << "at most 1e-5, but not 1e-6";

  const Time later = kNow + seconds(1);
  report = tracking_report(later);
  report.protection_level = {};
  publish(report, later);
  EXPECT_TRUE(is_sna("LOC_Integrity", "ProtectionLateral"));
  EXPECT_TRUE(is_sna("LOC_Integrity", "IntegrityRiskExponent"));
  EXPECT_EQ(value("LOC_Status", "State"), 2.0) << "a pose without a bound is still a pose";
}

TEST_F(PosePublisherTest, NoPoseIsSentWithoutTracking) {
  for (const auto state :
       {HealthState::kInit, HealthState::kAcquiring, HealthState::kLost, HealthState::kFault}) {
    PoseReport report = tracking_report(kNow);
    report.status.state = state;
    report.status.why = Why::kNoInitialPose | Why::kGnssMissing;
    publish(report, kNow);
    EXPECT_EQ(value("LOC_Status", "State"), static_cast<double>(state));
    EXPECT_EQ(value("LOC_Status", "Why_NoInitialPose"), 1.0);
    EXPECT_EQ(value("LOC_Status", "Why_GnssMissing"), 1.0);
    EXPECT_EQ(value("LOC_Status", "Why_PoseInvalid"), 0.0);
    expect_no_pose();
  }
}

TEST_F(PosePublisherTest, APoseThatIsNotFiniteIsNeverValid) {
  Time now = kNow;
  for (double Se2::*member : {&Se2::x_m, &Se2::y_m, &Se2::yaw_rad}) {
    for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
      now += seconds(1);
      PoseReport report = tracking_report(now);
      report.map_from_vehicle.*member = bad;
      publish(report, now);
      expect_lost_because("Why_PoseInvalid");
    }
  }
}

TEST_F(PosePublisherTest, APoseWithAnInvalidCovarianceIsNeverValid) {
  PoseReport report = tracking_report(kNow);
  report.covariance(0, 1) = kNan;
  publish(report, kNow);
  expect_lost_because("Why_PoseInvalid");

  report = tracking_report(kNow + seconds(1));
  report.covariance(2, 2) = -1e-6;
  publish(report, kNow + seconds(1));
  expect_lost_because("Why_PoseInvalid");

  report = tracking_report(kNow + seconds(2));
  report.covariance(0, 1) = report.covariance(1, 0) = 0.03;
  publish(report, kNow + seconds(2));
  expect_lost_because("Why_PoseInvalid");
}

TEST_F(PosePublisherTest, APositionOutOfRangeIsNotSaturated) {
  PoseReport report = tracking_report(kNow);
  report.map_from_vehicle.x_m = 83887.0;
  publish(report, kNow);
  expect_lost_because("Why_PoseInvalid");
}

TEST_F(PosePublisherTest, AStalePoseIsNeverValid) {
  PoseReport report = tracking_report(kNow);
  publish(report, kNow + milliseconds(51));
  expect_lost_because("Why_PoseStale");
  EXPECT_TRUE(is_sna("LOC_Velocity", "VelocityX"));
  EXPECT_TRUE(is_sna("LOC_Correction", "DeltaYaw"));

  const Time later = kNow + seconds(1);
  report = tracking_report(later);
  report.capture_time = later - milliseconds(5001);
  publish(report, later);
  expect_lost_because("Why_PoseStale");

  const Time latest = kNow + seconds(2);
  report = tracking_report(latest);
  report.capture_time.reset();
  publish(report, latest);
  expect_lost_because("Why_PoseStale");
  EXPECT_TRUE(is_sna("LOC_Time", "CaptureAge"));

  const Time last = kNow + seconds(3);
  report = tracking_report(last);
  report.capture_time = last + milliseconds(1);
  publish(report, last);
  expect_lost_because("Why_PoseStale");
  EXPECT_TRUE(is_sna("LOC_Time", "CaptureAge"));
}

/// Consumers take CaptureTime + CaptureAge as the time of the pose.
TEST_F(PosePublisherTest, TheAgeOfTheImagesLeadsToTheTimeOfAValidPose) {
  publish(tracking_report(kNow), kNow + kMaxPoseAge);
  EXPECT_EQ(value("LOC_Status", "State"), 2.0);
  EXPECT_NEAR(value("LOC_Time", "CaptureAge"), 83.0, 0.051);

  const Time later = kNow + seconds(1);
  publish(tracking_report(later), later + milliseconds(60));
  expect_lost_because("Why_PoseStale");
  EXPECT_NEAR(value("LOC_Time", "CaptureAge"), 143.0, 0.051) << "without a pose, until sending";
}

TEST_F(PosePublisherTest, ReturnsTheStatusThatItSends) {
  PoseReport report = tracking_report(kNow);
  EXPECT_EQ(publisher_.publish(report, kNow), report.status);
  const LocalizerStatus sent = publisher_.publish(report, kNow + milliseconds(60));
  EXPECT_EQ(sent.state, HealthState::kLost);
  EXPECT_TRUE(sent.why.has(Why::kPoseStale));
}

TEST_F(PosePublisherTest, AnAgeOfTheImagesBeyondTheRangeIsSna) {
  PoseReport report = tracking_report(kNow);
  report.capture_time = kNow - milliseconds(6553);
  publish(report, kNow);
  EXPECT_NEAR(value("LOC_Time", "CaptureAge"), 6553.0, 0.051);
  const Time later = kNow + seconds(1);
  report.capture_time = later - milliseconds(6554);
  publish(report, later);
  EXPECT_TRUE(is_sna("LOC_Time", "CaptureAge"));
}

TEST_F(PosePublisherTest, AnEmptyReportIsSnaEverywhere) {
  publish(PoseReport{}, kNow);
  expect_no_pose();
  for (const auto& [name, frame] : frames_) {
    for (const test::DbcSignal& signal : dbc_.message(name).signals) {
      const bool can_be_sna = std::ranges::any_of(
          signal.value_names, [](const auto& entry) { return entry.second == "SNA"; });
      EXPECT_EQ(signal.is_sna(frame.payload()), can_be_sna) << name << "." << signal.name;
    }
  }
}

TEST_F(PosePublisherTest, RandomReportsGiveNoSignalOutOfRange) {
  std::mt19937 random(7);
  const double odd[] = {0.0,  -0.0,     1e-300, 1e300,   -1e300,
                        kNan, 83886.07, -4e5,   3.14159, std::numeric_limits<double>::infinity()};
  const auto draw = [&] { return odd[random() % std::size(odd)]; };
  for (int i = 0; i < 5000; ++i) {
    const Time now = kNow + milliseconds(10 * i);
    PoseReport report = tracking_report(now);
    if (random() % 2 == 0) report.map_from_vehicle = {draw(), draw(), draw()};
    if (random() % 2 == 0) report.covariance.setConstant(draw());
    report.forward_speed_mps = draw();
    report.yaw_rate_radps = draw();
    report.correction = Se2{draw(), draw(), draw()};
    report.protection_level = {draw(), draw(), draw(), draw()};
    publish(report, now);
    for (const auto& [name, frame] : frames_) {
      for (const test::DbcSignal& signal : dbc_.message(name).signals) {
        if (signal.is_sna(frame.payload())) continue;
        const double physical = signal.physical_from(frame.payload());
        ASSERT_GE(physical, signal.min - 1e-9) << name << "." << signal.name;
        ASSERT_LE(physical, signal.max + 1e-9) << name << "." << signal.name;
      }
    }
  }
}

}  // namespace
}  // namespace bevloc::can
