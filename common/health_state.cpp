#include "common/health_state.h"

namespace bevloc {
namespace {

/// The switch has no default, so that the compiler warns when a reason has no text.
const char* text_of(Why why) {
  switch (why) {
    case Why::kCameraMissing:
      return "camera missing";
    case Why::kCamerasUnsynchronized:
      return "cameras unsynchronized";
    case Why::kOdometryMissing:
      return "odometry missing";
    case Why::kGnssMissing:
      return "GNSS missing";
    case Why::kNoInitialPose:
      return "no initial pose";
    case Why::kOutsideMap:
      return "outside map";
    case Why::kMatchUncertain:
      return "match uncertain";
    case Why::kMatchRejected:
      return "match rejected";
    case Why::kPoseUncertain:
      return "pose uncertain";
    case Why::kPoseStale:
      return "pose stale";
    case Why::kPoseInvalid:
      return "pose invalid";
    case Why::kOverload:
      return "overload";
    case Why::kMapFault:
      return "map fault";
    case Why::kCalibrationFault:
      return "calibration fault";
    case Why::kNetworkFault:
      return "network fault";
    case Why::kInternalFault:
      return "internal fault";
    case Why::kGnssContradicts:
      return "GNSS contradicts";
    case Why::kOdometryContradicts:
      return "odometry contradicts";
    case Why::kMatchContradicts:
      return "match contradicts";
    case Why::kClockGap:
      return "clock gap";
    case Why::kOdometryImplausible:
      return "odometry implausible";
    case Why::kForeignSender:
      return "foreign sender";
  }
  return "";
}

}  // namespace

const char* to_string(HealthState state) {
  switch (state) {
    case HealthState::kInit:
      return "INIT";
    case HealthState::kAcquiring:
      return "ACQUIRING";
    case HealthState::kTracking:
      return "TRACKING";
    case HealthState::kDegraded:
      return "DEGRADED";
    case HealthState::kLost:
      return "LOST";
    case HealthState::kFault:
      return "FAULT";
  }
  return "?";
}

std::string to_string(WhyMask why) {
  std::string text;
  for_each_reason(why, [&](Why reason) {
    if (!text.empty()) text += ", ";
    text += text_of(reason);
  });
  return text;
}

}  // namespace bevloc
