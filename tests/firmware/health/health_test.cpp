#include "firmware/health/health.h"

#include <array>

#include <gtest/gtest.h>

#include "can/publisher/solution_frames.h"
#include "tests/firmware/health/healthy_inputs.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::healthy;
using test::tracking;

/// The standard deviation of the pose along one axis, and its limit.
struct SigmaAxis {
  double HealthInputs::*sigma;
  double HealthLimits::*limit;
};

/// In the order of HealthLimits::alert_limit: longitudinal, lateral, yaw.
constexpr std::array<SigmaAxis, 3> kSigmaAxes = {{
    {&HealthInputs::longitudinal_sigma_m, &HealthLimits::longitudinal_sigma_m},
    {&HealthInputs::lateral_sigma_m, &HealthLimits::lateral_sigma_m},
    {&HealthInputs::yaw_sigma_rad, &HealthLimits::yaw_sigma_rad},
}};

TEST(HealthTest, CamerasOutOfStepDegrade) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.cameras_unsynchronized = true;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  EXPECT_EQ(health.why(), WhyMask(Why::kCamerasUnsynchronized));
}

TEST(HealthTest, StaysInInitWithoutAFirstPose) {
  Health health{HealthLimits()};
  EXPECT_FALSE(health.update(HealthInputs()));
  EXPECT_EQ(health.state(), HealthState::kInit);
  EXPECT_TRUE(health.why().has(Why::kNoInitialPose));
  EXPECT_FALSE(health.pose_valid());
}

TEST(HealthTest, AcquiresUntilEnoughCorrectionsWereAccepted) {
  Health health{HealthLimits()};
  HealthInputs inputs = healthy();
  inputs.accepted_in_a_row = HealthLimits().corrections_to_track - 1;
  health.update(inputs);
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kAcquiring);
  EXPECT_FALSE(health.pose_valid());
  ++inputs.accepted_in_a_row;
  EXPECT_TRUE(health.update(inputs));
  EXPECT_EQ(health.state(), HealthState::kTracking);
  EXPECT_TRUE(health.pose_valid());
}

TEST(HealthTest, SaysWhatANewPoseLacks) {
  const auto reason_with = [](const HealthInputs& inputs) {
    Health health{HealthLimits()};
    health.update(healthy());
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kAcquiring);
    return health.why();
  };
  HealthInputs few_matches = healthy();
  few_matches.accepted_in_a_row = HealthLimits().corrections_to_track - 1;
  EXPECT_EQ(reason_with(few_matches), WhyMask(Why::kMatchUncertain));
  HealthInputs far_from_gnss = healthy();
  far_from_gnss.start_confirmed = false;
  EXPECT_EQ(reason_with(far_from_gnss), WhyMask(Why::kMatchUncertain));
  HealthInputs wide = healthy();
  wide.lateral_sigma_m = 0.3 * HealthLimits().alert_limit.y();
  ASSERT_LT(wide.lateral_sigma_m, HealthLimits().lateral_sigma_m);
  EXPECT_EQ(reason_with(wide), WhyMask(Why::kPoseUncertain));
}

TEST(HealthTest, AValidPoseNeedsNoSigmaOfANewOne) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.lateral_sigma_m = 0.3 * HealthLimits().alert_limit.y();
  inputs.accepted_in_a_row = 0;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kTracking);
}

TEST(HealthTest, AnUncertainPoseIsNeverTracked) {
  HealthLimits limits;
  limits.alert_limit.setConstant(100.0);  // only the limits of the sigmas can refuse the pose
  for (const auto& [sigma, limit] : kSigmaAxes) {
    Health health(limits);
    HealthInputs inputs = healthy();
    inputs.*sigma = limits.*limit + 0.001;
    for (int i = 0; i < 5; ++i) health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kAcquiring) << limits.*limit;
    EXPECT_TRUE(health.why().has(Why::kPoseUncertain)) << limits.*limit;
    inputs.*sigma = limits.*limit - 0.001;
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kTracking) << limits.*limit;
  }
}

TEST(HealthTest, AMissingCameraDegradesUntilItReturns) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.cameras_present.reset(2);
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  EXPECT_TRUE(health.pose_valid());
  EXPECT_EQ(health.why(), WhyMask(Why::kCameraMissing));
  health.update(healthy());
  EXPECT_EQ(health.state(), HealthState::kTracking);
}

TEST(HealthTest, MissingCorrectionsDegradeAndThenLose) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.correction_age = HealthLimits().correction_timeout + milliseconds(1);
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  EXPECT_TRUE(health.why().has(Why::kPoseStale));
  inputs.correction_age = HealthLimits().lost_timeout + milliseconds(1);
  EXPECT_TRUE(health.update(inputs));
  EXPECT_EQ(health.state(), HealthState::kLost);
  EXPECT_FALSE(health.pose_valid());
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kAcquiring);
}

TEST(HealthTest, APoseThatThePublisherHoldsTooOldIsLost) {
  HealthLimits patient;
  patient.lost_timeout = seconds(10);
  Health health(patient);
  health.update(healthy());
  health.update(healthy());
  HealthInputs inputs = healthy();
  inputs.match_age = can::kMaxCaptureAge;
  inputs.correction_age = inputs.match_age;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  inputs.match_age += milliseconds(1);
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kLost);
}

TEST(HealthTest, RefusedCorrectionsInARowLose) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.latest_correction_refused = true;
  inputs.accepted_in_a_row = 0;
  inputs.refused_in_a_row = HealthLimits().refusals_to_lose - 1;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  EXPECT_TRUE(health.why().has(Why::kMatchRejected));
  ++inputs.refused_in_a_row;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded) << "the arbiter has decided who is wrong";
  inputs.verdict.undecided = true;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kLost);
}

TEST(HealthTest, ANewPoseFarFromGnssIsNotTracked) {
  Health health{HealthLimits()};
  HealthInputs inputs = healthy();
  inputs.start_confirmed = false;
  for (int i = 0; i < 5; ++i) health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kAcquiring);
  EXPECT_TRUE(health.why().has(Why::kMatchUncertain));
}

TEST(HealthTest, AnExcludedVoterDegradesAndIsNamed) {
  for (const auto& [voter, why] : {std::pair{&Verdict::gnss_contradicts, Why::kGnssContradicts},
                                   {&Verdict::match_contradicts, Why::kMatchContradicts}}) {
    Health health = tracking();
    HealthInputs inputs = healthy();
    inputs.verdict.*voter = true;
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kDegraded);
    EXPECT_EQ(health.why(), WhyMask(why));
  }
}

TEST(HealthTest, AForeignSenderDegrades) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.foreign_sender = true;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  EXPECT_EQ(health.why(), WhyMask(Why::kForeignSender));
}

TEST(HealthTest, WrongOdometryAndClockGapsLose) {
  for (const auto& [change, why] :
       {std::pair{+[](HealthInputs& i) { i.verdict.odometry_contradicts = true; },
                  Why::kOdometryContradicts},
        {+[](HealthInputs& i) { i.odometry_implausible = true; }, Why::kOdometryImplausible},
        {+[](HealthInputs& i) { i.clock_gap = true; }, Why::kClockGap}}) {
    Health health = tracking();
    HealthInputs inputs = healthy();
    change(inputs);
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kLost);
    EXPECT_TRUE(health.why().has(why));
  }
}

TEST(HealthTest, AnUncertainPoseIsLost) {
  const HealthLimits limits;
  for (const auto& [sigma, limit] : kSigmaAxes) {
    Health health = tracking();
    HealthInputs inputs = healthy();
    inputs.*sigma = limits.*limit - 0.001;
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kTracking) << limits.*limit;
    inputs.*sigma = limits.*limit + 0.001;
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kLost) << limits.*limit;
    EXPECT_TRUE(health.why().has(Why::kPoseUncertain)) << limits.*limit;
  }
}

TEST(HealthTest, WithoutOdometryThePoseIsLost) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.odometry_age = seconds(1);
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kLost);
  EXPECT_TRUE(health.why().has(Why::kOdometryMissing));
}

TEST(HealthTest, MissingGnssOnlyDegrades) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.gnss_age = seconds(60);
  for (int i = 0; i < 10; ++i) health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  EXPECT_TRUE(health.why().has(Why::kGnssMissing));
}

TEST(HealthTest, ACameraThatIsNotWhereTheCalibrationHasItDegrades) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.calibration_fault = true;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  EXPECT_EQ(health.why(), WhyMask(Why::kCalibrationFault));
}

TEST(HealthTest, OutsideTheMapDegrades) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.map_nearby = false;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  EXPECT_EQ(health.why(), WhyMask(Why::kOutsideMap));
}

TEST(HealthTest, OverloadDegrades) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.overloaded = true;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
  EXPECT_EQ(health.why(), WhyMask(Why::kOverload));
  health.update(healthy());
  EXPECT_EQ(health.state(), HealthState::kTracking);
}

TEST(HealthTest, AnInternalErrorIsAPermanentFault) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.internal_error = true;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kFault);
  health.update(healthy());
  EXPECT_EQ(health.state(), HealthState::kFault);
  EXPECT_FALSE(health.pose_valid());
}

TEST(HealthTest, AFaultOfTheNetworkIsPermanentAndNamed) {
  for (Health health : {tracking(), Health(HealthLimits{})}) {
    HealthInputs inputs = healthy();
    inputs.network_fault = true;
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kFault);
    EXPECT_TRUE(health.why().has(Why::kNetworkFault));
    health.update(healthy());
    EXPECT_EQ(health.state(), HealthState::kFault);
    EXPECT_FALSE(health.pose_valid());
  }
}

TEST(HealthTest, NamesTheReasonsInWords) {
  EXPECT_EQ(to_string(Why::kCameraMissing | Why::kPoseStale), "camera missing, pose stale");
  EXPECT_EQ(to_string(WhyMask()), "");
  EXPECT_EQ(to_string(Why::kInternalFault | Why::kForeignSender), "internal fault, foreign sender");
}

TEST(HealthTest, ANewPoseMustBeWellWithinTheAlertLimits) {
  const HealthLimits limits;
  for (size_t axis = 0; axis < kSigmaAxes.size(); ++axis) {
    const auto& [sigma, limit] = kSigmaAxes[axis];
    const double alert_limit = limits.alert_limit(static_cast<Eigen::Index>(axis));
    const double wide = 0.26 * alert_limit;
    ASSERT_LT(wide, limits.*limit) << "good enough to keep a pose, axis " << axis;
    Health health(limits);
    HealthInputs inputs = healthy();
    inputs.*sigma = wide;
    health.update(inputs);
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kAcquiring) << "axis " << axis;
    EXPECT_EQ(health.why(), WhyMask(Why::kPoseUncertain)) << "axis " << axis;
    inputs.*sigma = 0.24 * alert_limit;
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kTracking) << "axis " << axis;
    inputs.*sigma = wide;
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kTracking) << "axis " << axis;
  }
}

TEST(HealthTest, WrongTimeStampsLoseThePoseAndAreNamed) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.stamps_contradict = true;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kLost);
  EXPECT_TRUE(health.why().has(Why::kCalibrationFault));
}

TEST(HealthTest, GnssThatLagsLosesThePoseAndIsNamed) {
  Health health = tracking();
  HealthInputs inputs = healthy();
  inputs.gnss_lags = true;
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kLost);
  EXPECT_TRUE(health.why().has(Why::kGnssContradicts));
}

}  // namespace
}  // namespace bevloc::firmware
