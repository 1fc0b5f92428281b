#include <gtest/gtest.h>

#include "tests/firmware/health/healthy_inputs.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::healthy;
using test::tracking;

/// Returns the inputs for a pose that no match has confirmed for `age`, with these protection
/// levels.
HealthInputs unmatched(Duration age, double across_m, double heading_rad) {
  HealthInputs inputs = healthy();
  inputs.correction_age = age;
  inputs.protection_level = {0.0, across_m, heading_rad};
  return inputs;
}

TEST(HealthTest, LosesAPoseSoonerThatOnlyOdometrySupports) {
  const HealthLimits limits;
  const Duration soon = limits.correction_timeout + milliseconds(1);
  HealthInputs inputs = unmatched(soon, limits.alert_limit.y() + 0.01, 0.0);
  const auto state_with = [&inputs](bool Verdict::*verdict, bool value) {
    inputs.verdict = {};
    inputs.verdict.*verdict = value;
    Health health = tracking();
    health.update(inputs);
    return health.state();
  };
  EXPECT_EQ(state_with(&Verdict::gnss_excluded, false), HealthState::kDegraded);
  EXPECT_EQ(state_with(&Verdict::gnss_contradicts, true), HealthState::kDegraded) << "scatters";
  EXPECT_EQ(state_with(&Verdict::gnss_excluded, true), HealthState::kLost);
  EXPECT_EQ(state_with(&Verdict::match_contradicts, true), HealthState::kLost);
}

/// The longest `degraded_after_ms` is 5 s.
TEST(HealthTest, ALongTimeUntilDegradedDoesNotKeepADisputedPoseLonger) {
  HealthLimits patient;
  patient.correction_timeout = seconds(5);
  HealthInputs inputs = unmatched(milliseconds(3001), patient.alert_limit.y() + 0.01, 0.0);
  const auto state_with = [&](bool Verdict::*verdict) {
    inputs.verdict = {};
    inputs.verdict.*verdict = true;
    Health health = tracking(patient);
    health.update(inputs);
    return health.state();
  };
  for (const auto verdict : {&Verdict::gnss_excluded, &Verdict::match_contradicts}) {
    EXPECT_EQ(state_with(verdict), HealthState::kLost);
  }
  inputs = unmatched(milliseconds(2001), patient.alert_limit.y() + 0.01, 0.0);
  inputs.valid_age = milliseconds(4999);
  EXPECT_EQ(state_with(&Verdict::gnss_excluded), HealthState::kLost) << "a new pose";
}

TEST(HealthTest, LosesANewPoseSooner) {
  const double beyond_m = HealthLimits().alert_limit.y() + 0.01;
  const auto state_after = [beyond_m](Duration correction_age, Duration valid_age) {
    HealthInputs inputs = unmatched(correction_age, beyond_m, 0.0);
    inputs.valid_age = valid_age;
    Health health = tracking();
    health.update(inputs);
    return health.state();
  };
  EXPECT_EQ(state_after(milliseconds(2001), milliseconds(4999)), HealthState::kLost);
  EXPECT_EQ(state_after(milliseconds(2000), milliseconds(4999)), HealthState::kDegraded);
  EXPECT_EQ(state_after(milliseconds(2001), milliseconds(5000)), HealthState::kDegraded);
}

TEST(HealthTest, KeepsAProtectedPoseAlsoWhileAVoterIsExcluded) {
  const HealthLimits limits;
  HealthInputs inputs = unmatched(milliseconds(2900), limits.alert_limit.y() - 0.01, 0.0);
  inputs.verdict.match_contradicts = true;
  Health health = tracking();
  health.update(inputs);
  EXPECT_EQ(health.state(), HealthState::kDegraded);
}

TEST(HealthTest, LosesAPoseWithoutMatchesWhoseProtectionLevelIsBeyondTheAlertLimit) {
  const Eigen::Vector3d limit = HealthLimits().alert_limit;
  for (const auto& inputs : {unmatched(milliseconds(3001), limit.y() + 0.01, 0.0),
                             unmatched(milliseconds(3001), 0.0, limit.z() + 0.001)}) {
    Health health = tracking();
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kLost);
    EXPECT_TRUE(health.why().has(Why::kPoseUncertain));
  }
}

TEST(HealthTest, KeepsAPoseWithoutMatchesWithinTheAlertLimits) {
  const Eigen::Vector3d limit = HealthLimits().alert_limit;
  for (const auto& inputs : {unmatched(milliseconds(3001), limit.y() - 0.01, limit.z() - 0.001),
                             unmatched(milliseconds(2999), limit.y() + 0.01, 0.0)}) {
    Health health = tracking();
    health.update(inputs);
    EXPECT_EQ(health.state(), HealthState::kDegraded);
  }
}

}  // namespace
}  // namespace bevloc::firmware
