// What the daemon tells about itself. /metrics, /healthz, /status.json, the live page and `bevloc
// status` show this value.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/runtime/supervisor.h"
#include "firmware/status/snapshot.h"

namespace bevloc::firmware {

enum class Phase : uint8_t {
  kStarting,  ///< no appliance runs yet
  kRunning,
  kStandby,  ///< the ignition is off
};

/// All counters and the supervisor's view at one moment, as a plain value.
struct Telemetry {
  Phase phase = Phase::kStarting;
  Time time{};  ///< when it was taken, by the appliance's clock
  Snapshot snapshot{};
  ApplianceView view{};
};

/// Whether the daemon does what it is configured to do.
struct HealthCheck {
  bool good = false;
  std::string reason;  ///< one line with the state, what is wrong and what to do
};

/// The check is good while the pose is valid, in standby, and during a start if nobody needs to
/// act. It is not good while a thread hangs, in LOST and FAULT, and when a pose that was valid
/// has not been so for ten seconds. Before the pose is valid, it is not good when an input is
/// missing or wrong, or when the map does not cover the place or does not fit it. It is also not
/// good when `age`, the time since the supervisor handed the value over, is longer than two
/// seconds.
HealthCheck check_health(const Telemetry& telemetry, Duration age);

/// Whether consumers may use the pose. They may not use it if it is older than two seconds, because
/// the supervisor (`age`, as above) or the thread that sends it hangs.
bool pose_is_valid(const Telemetry& telemetry, Duration age);

/// Return the reason in words ("camera missing"), and one sentence that says what to do about it.
std::string words_of(Why why);
const char* advice_for(Why why);

}  // namespace bevloc::firmware
