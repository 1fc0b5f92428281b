#include "firmware/stages/estimation_stage.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "can/messages/localizer_messages.h"
#include "pipeline/map/map_check.h"
#include "tests/firmware/stages/estimation_stage_fixture.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using test::EstimationStageTest;

TEST_F(EstimationStageTest, CorrectsTheGnssOffsetAndSendsTheTruth) {
  run(milliseconds(5000));
  EXPECT_EQ(stage_.counters().state, HealthState::kTracking);
  ASSERT_TRUE(latest_);
  const Se2 error = correction_between(truth_at(latest_->received), latest_->map_from_vehicle);
  EXPECT_NEAR(error.x_m, 0.0, 0.05);
  EXPECT_NEAR(error.y_m, 0.0, 0.05);
}

TEST_F(EstimationStageTest, SendsNoPoseBeforeVisionConfirmsIt) {
  vision_ = false;
  run(milliseconds(5000));
  EXPECT_EQ(stage_.counters().state, HealthState::kAcquiring);
  EXPECT_FALSE(latest_);
}

TEST_F(EstimationStageTest, PredictsForVisionAndRequestsAWideSearchUntilTracking) {
  vision_ = false;
  run(milliseconds(1000));
  std::optional<Prediction> prediction = take_prediction();
  ASSERT_TRUE(prediction);
  EXPECT_TRUE(prediction->acquiring);
  vision_ = true;
  run(milliseconds(5000));
  prediction = take_prediction();
  ASSERT_TRUE(prediction);
  EXPECT_FALSE(prediction->acquiring);
}

TEST_F(EstimationStageTest, ReportsTheCovarianceAlongTheAxesOfTheMap) {
  winding_ = true;
  std::optional<can::PoseReport> report;
  stage_.observe_reports([&report](const can::PoseReport& sent) { report = sent; });
  run(milliseconds(5000));
  const auto prediction = take_prediction();
  ASSERT_TRUE(report);
  ASSERT_TRUE(prediction);
  const double yaw_rad = report->map_from_vehicle.yaw_rad;
  EXPECT_NEAR(yaw_rad, 1.2, 0.1);
  const Eigen::Matrix3d map_from_vehicle =
      Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d in_vehicle =
      map_from_vehicle.transpose() * report->covariance * map_from_vehicle;
  const Eigen::Matrix3d& wanted = prediction->pose.covariance;
  EXPECT_TRUE(in_vehicle.isApprox(wanted, 1e-9)) << in_vehicle << "\n\n" << wanted;
  EXPECT_FALSE(report->covariance.isApprox(wanted, 0.01)) << "equal errors along and across";
}

TEST_F(EstimationStageTest, ReportsTheProtectionLevelOfEachAxis) {
  std::optional<can::PoseReport> report;
  stage_.observe_reports([&report](const can::PoseReport& sent) { report = sent; });
  run(milliseconds(5000));
  ASSERT_TRUE(report);
  const can::ProtectionLevel& sent = report->protection_level;
  const std::array<double, 3> levels = {sent.longitudinal_m, sent.lateral_m, sent.yaw_rad};
  const PoseSnapshot pose = stage_.counters().pose.load();
  EXPECT_EQ(levels, pose.protection_level);
  EXPECT_EQ(sent.integrity_risk, ProtectionParameters().integrity_risk);
  for (size_t axis = 0; axis < levels.size(); ++axis) {
    // While GNSS agrees, the level is the quantile of a normal error (protection_level()).
    EXPECT_NEAR(levels[axis] / pose.sigma[axis], 4.417 * ProtectionParameters().tail_factor, 0.02)
        << "axis " << axis;
  }
  EXPECT_GT(levels[0], 1.05 * levels[1]) << "the errors along and across must differ";
}

TEST(EstimationStage, SendsTheFarthestPlacesOfAMap) {
  EXPECT_LT(kFarthestFromOriginM, can::loc_pos_local::kEast.max);
  EXPECT_LT(kFarthestFromOriginM, can::loc_pos_local::kNorth.max);
}

TEST_F(EstimationStageTest, RefusesAMatchThatContradictsOdometry) {
  run(milliseconds(5000));
  vision_error_ = {3.0, 2.0, 0.1};
  run(milliseconds(300));  // too short for LOST
  EXPECT_GT(corrections(TrackerUpdate::kGated), 0U);
  EXPECT_EQ(stage_.counters().state, HealthState::kDegraded);
  const Se2 error = correction_between(truth_at(latest_->received), latest_->map_from_vehicle);
  EXPECT_NEAR(error.x_m, 0.0, 0.1);
  EXPECT_NEAR(error.y_m, 0.0, 0.1);
}

TEST_F(EstimationStageTest, RecoversFromAWrongMatchWhileAcquiring) {
  vision_error_ = {1.5, 1.2, 0.03};
  run(milliseconds(700));  // long enough to be accepted, too short for TRACKING
  ASSERT_GT(corrections(TrackerUpdate::kAccepted), 0U);
  ASSERT_EQ(stage_.counters().state, HealthState::kAcquiring);
  vision_error_ = {};
  run(milliseconds(4000));
  EXPECT_EQ(stage_.counters().state, HealthState::kTracking);
  const Se2 error = correction_between(truth_at(latest_->received), latest_->map_from_vehicle);
  EXPECT_NEAR(error.x_m, 0.0, 0.1);
  EXPECT_NEAR(error.y_m, 0.0, 0.1);
}

TEST_F(EstimationStageTest, APoseThatStartedAgainNeedsNewMatches) {
  vision_error_ = {0.0, -2.5, 0.0};  // too far from GNSS for TRACKING
  run(milliseconds(3000));
  ASSERT_EQ(stage_.counters().state, HealthState::kAcquiring);
  ASSERT_GT(corrections(TrackerUpdate::kAccepted),
            static_cast<uint64_t>(HealthLimits().corrections_to_track));
  gnss_north_m_ = 8.0;  // refutes the pose
  vision_ = false;
  const auto has_started_again = [this] { return why().has(Why::kNoInitialPose); };
  for (int i = 0; i < 500 && !has_started_again(); ++i) run(milliseconds(10));
  ASSERT_TRUE(has_started_again());
  gnss_north_m_ = 1.0;
  run(milliseconds(300));
  EXPECT_FALSE(why().has(Why::kNoInitialPose));
  EXPECT_TRUE(why().has(Why::kMatchUncertain));
  EXPECT_TRUE(why().has(Why::kPoseStale));
}

/// Their frames were exposed before the first GNSS sample of the new pose.
TEST_F(EstimationStageTest, MatchesFromBeforeANewPoseAreNeitherTooOldNorRefused) {
  run(milliseconds(3000));
  vision_ = false;
  run(milliseconds(1000));
  gnss_north_m_ = 30.0;
  const auto has_started_again = [this] { return why().has(Why::kNoInitialPose); };
  for (int i = 0; i < 500 && !has_started_again(); ++i) run(milliseconds(10));
  ASSERT_TRUE(has_started_again());
  const Time before = now_ - milliseconds(10);
  run(milliseconds(110));
  ASSERT_FALSE(why().has(Why::kNoInitialPose));
  for (int i = 5; i > 0; --i) push_report(before - i * milliseconds(5));
  run(milliseconds(10));
  EXPECT_EQ(corrections(TrackerUpdate::kTooOld), 0U);
  EXPECT_GT(corrections(TrackerUpdate::kNotInitialised), 0U) << "the mean score is high enough";
  EXPECT_FALSE(why().has(Why::kMatchRejected));
}

TEST_F(EstimationStageTest, ReportsThatVisionSkipsFramesets) {
  run(milliseconds(5000));
  EXPECT_EQ(stage_.counters().why, 0);
  skipped_ = true;
  run(milliseconds(200));
  EXPECT_EQ(stage_.counters().why, WhyMask(Why::kOverload).bits());
  skipped_ = false;
  run(milliseconds(200));
  EXPECT_EQ(stage_.counters().why, 0);
}

TEST_F(EstimationStageTest, LosesThePoseWhileTheStampsAreWrong) {
  run(milliseconds(5000));
  stamps_jumped_ = true;
  run(milliseconds(200));
  latest_.reset();
  EXPECT_TRUE(why().has(Why::kCalibrationFault));
  run(milliseconds(5000));
  EXPECT_FALSE(latest_) << "no valid pose";
  stamps_jumped_ = false;
  run(milliseconds(5000));
  EXPECT_EQ(stage_.counters().state, HealthState::kTracking);
}

TEST_F(EstimationStageTest, ReportsAllCamerasMissingWithoutFramesets) {
  run(milliseconds(5000));
  EXPECT_EQ(stage_.counters().cameras, 0b111111U);
  vision_ = false;
  run(milliseconds(500));
  EXPECT_EQ(stage_.counters().cameras, 0U);
  EXPECT_EQ(stage_.counters().state, HealthState::kDegraded);
  EXPECT_EQ(stage_.counters().why, (Why::kCameraMissing | Why::kPoseStale).bits());
  vision_ = true;
  run(milliseconds(500));
  EXPECT_EQ(stage_.counters().cameras, 0b111111U);
  EXPECT_EQ(stage_.counters().state, HealthState::kTracking);
}

/// The cameras deliver, but vision is slow.
TEST_F(EstimationStageTest, SlowFramesetsAreNotMissingCameras) {
  run(milliseconds(5000));
  report_period_ = milliseconds(400);
  run(milliseconds(1000));
  for (int i = 0; i < 500; ++i) {
    run(milliseconds(10));
    ASSERT_EQ(stage_.counters().cameras, 0b111111U) << i;
  }
}

TEST_F(EstimationStageTest, StopsSendingPosesWithoutOdometry) {
  run(milliseconds(5000));
  odometry_ = false;
  run(milliseconds(1000));
  EXPECT_NE(stage_.counters().state, HealthState::kTracking);
  latest_.reset();
  run(milliseconds(500));
  EXPECT_FALSE(latest_);
}

TEST_F(EstimationStageTest, GnssIsThereWhileOdometryIsMissing) {
  run(milliseconds(5000));
  odometry_ = false;
  run(milliseconds(3000));
  EXPECT_TRUE(why().has(Why::kOdometryMissing));
  EXPECT_FALSE(why().has(Why::kGnssMissing));
}

/// Nine good matches, a time without any, and one more do not make ten.
TEST_F(EstimationStageTest, MatchesBeforeAPauseDoNotConfirmAStart) {
  run(milliseconds(1000));
  ASSERT_EQ(stage_.counters().state, HealthState::kAcquiring);
  ASSERT_LT(corrections(TrackerUpdate::kAccepted),
            static_cast<uint64_t>(HealthLimits().corrections_to_track));
  vision_ = false;
  run(milliseconds(4000));
  vision_ = true;
  run(milliseconds(300));
  EXPECT_EQ(stage_.counters().state, HealthState::kAcquiring);
  run(milliseconds(2000));
  EXPECT_EQ(stage_.counters().state, HealthState::kTracking);
}

TEST_F(EstimationStageTest, CountsLossesAndKeepsTheReasonAndTheTime) {
  const EstimationCounters& counters = stage_.counters();
  run(milliseconds(5000));
  EXPECT_EQ(counters.lost, 0U);
  EXPECT_EQ(counters.invalid_since.load(), Time::max());
  odometry_ = false;
  const Time stopped = now_;
  run(milliseconds(1000));
  ASSERT_NE(counters.state, HealthState::kLost) << "LOST lasts one cycle";
  EXPECT_EQ(counters.lost, 1U);
  EXPECT_TRUE(WhyMask::from_bits(counters.lost_why).has(Why::kOdometryMissing));
  EXPECT_GT(counters.invalid_since.load(), stopped + milliseconds(150));
  EXPECT_LT(counters.invalid_since.load(), stopped + milliseconds(300));
  odometry_ = true;
  run(milliseconds(5000));
  EXPECT_EQ(counters.state, HealthState::kTracking);
  EXPECT_EQ(counters.lost, 1U);
  EXPECT_EQ(counters.invalid_since.load(), Time::max());
}

TEST_F(EstimationStageTest, NanFromVisionChangesNothing) {
  run(milliseconds(5000));
  vision_error_ = {std::nan(""), 0.0, 0.0};
  run(milliseconds(1000));
  const Se2 error = correction_between(truth_at(latest_->received), latest_->map_from_vehicle);
  EXPECT_NEAR(error.x_m, 0.0, 0.2);
  EXPECT_TRUE(latest_->map_from_vehicle.is_finite());
}

TEST_F(EstimationStageTest, SignsOffWithoutAPose) {
  run(milliseconds(5000));
  ASSERT_EQ(stage_.counters().state, HealthState::kTracking);
  stage_.sign_off(now_);
  std::optional<can::ReceivedFrame> status;
  std::optional<evaluation::BusPose> pose;
  while (const auto received = listener_->receive()) {
    if (received->frame.id == can::BaseIds().localizer) status = received;
    if (const auto accepted = reader_.accept(*received)) pose = accepted;
  }
  EXPECT_FALSE(pose) << "the last epoch must not contain a pose";
  ASSERT_TRUE(status);
  // LOC_Status.State is the low nibble of byte 2.
  EXPECT_EQ(status->frame.data[2] & 0x0FU, static_cast<unsigned>(HealthState::kLost));
}

TEST_F(EstimationStageTest, CallsTheObserverOncePerCorrectionThatWasSent) {
  std::vector<Time> sent;
  stage_.observe_corrections([&sent](Time frame_time) { sent.push_back(frame_time); });
  run(milliseconds(5000));
  ASSERT_FALSE(sent.empty());
  for (size_t i = 1; i < sent.size(); ++i) EXPECT_GT(sent[i], sent[i - 1]);
}

/// Without matches, the arbiter does not exclude GNSS.
TEST_F(EstimationStageTest, ARefusedYawRateDoesNotHideThatGnssIsTooOld) {
  winding_ = true;
  gnss_heading_age_s_ = 0.5;
  vision_ = false;
  run(std::chrono::milliseconds(1000));
  const Time after_latest = now_ - std::chrono::milliseconds(10);
  samples_.push(OdometrySample{after_latest, kSpeed_mps, std::nan("")});
  run(std::chrono::milliseconds(30'000));
  EXPECT_GT(stage_.counters().gnss_lag_ms, 0);
}

}  // namespace
}  // namespace bevloc::firmware
