// What a daemon that runs tells about itself.
#pragma once

#include "firmware/status/telemetry.h"

namespace bevloc::firmware {

inline Telemetry running(HealthState state, WhyMask why = {}) {
  Telemetry telemetry;
  telemetry.phase = Phase::kRunning;
  EstimationSnapshot& estimation = telemetry.snapshot.estimation;
  estimation.state = state;
  estimation.why = why;
  estimation.pose.known = true;
  estimation.pose.valid = state == HealthState::kTracking || state == HealthState::kDegraded;
  estimation.pose.sigma = {0.25, 0.5, radians(1.0)};
  estimation.pose.protection_level = {1.25, 1.5, radians(2.0)};
  return telemetry;
}

}  // namespace bevloc::firmware
