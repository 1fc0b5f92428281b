#include "common/health_state.h"

#include <array>
#include <string_view>
#include <utility>

namespace bevloc {
namespace {

constexpr std::array<std::pair<Why, const char*>, 16> kReasonTexts = {{
    {Why::kCameraMissing, "camera missing"},
    {Why::kCamerasUnsynchronized, "cameras unsynchronized"},
    {Why::kOdometryMissing, "odometry missing"},
    {Why::kGnssMissing, "GNSS missing"},
    {Why::kNoInitialPose, "no initial pose"},
    {Why::kOutsideMap, "outside map"},
    {Why::kMatchUncertain, "match uncertain"},
    {Why::kMatchRejected, "match rejected"},
    {Why::kPoseUncertain, "pose uncertain"},
    {Why::kPoseStale, "pose stale"},
    {Why::kPoseInvalid, "pose invalid"},
    {Why::kOverload, "overload"},
    {Why::kMapFault, "map fault"},
    {Why::kCalibrationFault, "calibration fault"},
    {Why::kNetworkFault, "network fault"},
    {Why::kInternalFault, "internal fault"},
}};

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
  for (const auto& [reason, name] : kReasonTexts) {
    if (!why.has(reason)) continue;
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

}  // namespace bevloc
