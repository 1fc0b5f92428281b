// Inputs without a fault, for the tests of the state machine.
#pragma once

#include <gtest/gtest.h>

#include "firmware/health/health.h"

namespace bevloc::test {

/// All inputs are present and corrections are accepted.
inline firmware::HealthInputs healthy() {
  firmware::HealthInputs inputs;
  inputs.initialized = true;
  inputs.odometry_age = std::chrono::milliseconds(20);
  inputs.gnss_age = std::chrono::milliseconds(100);
  inputs.correction_age = std::chrono::milliseconds(100);
  inputs.match_age = std::chrono::milliseconds(100);
  inputs.cameras_present.set();
  inputs.accepted_in_a_row = 100;
  inputs.longitudinal_sigma_m = 0.1;
  inputs.lateral_sigma_m = 0.05;
  inputs.yaw_sigma_rad = 0.002;
  return inputs;
}

/// Returns a state machine in the state TRACKING.
inline firmware::Health tracking(const firmware::HealthLimits& limits = {}) {
  firmware::Health health(limits);
  health.update(healthy());
  health.update(healthy());
  EXPECT_EQ(health.state(), HealthState::kTracking);
  return health;
}

}  // namespace bevloc::test
