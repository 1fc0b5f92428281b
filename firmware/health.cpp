#include "firmware/health.h"

#include <array>
#include <utility>

namespace bevloc::firmware {
namespace {

using can::Why;

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

const char* to_string(State state) {
  switch (state) {
    case State::kInit:
      return "INIT";
    case State::kAcquiring:
      return "ACQUIRING";
    case State::kTracking:
      return "TRACKING";
    case State::kDegraded:
      return "DEGRADED";
    case State::kLost:
      return "LOST";
    case State::kFault:
      return "FAULT";
  }
  return "?";
}

std::string to_string(can::WhyMask why) {
  std::string text;
  for (const auto& [reason, name] : kReasonTexts) {
    if (!why.has(reason)) continue;
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

bool Health::update(const HealthInputs& inputs) {
  why_ = find_reasons(inputs);
  contradicted_ = inputs.contradicts_gnss || inputs.refused_in_a_row >= limits_.refusals_to_lose;
  const State before = std::exchange(state_, next_state(inputs));
  return state_ != before;
}

can::WhyMask Health::find_reasons(const HealthInputs& inputs) const {
  can::WhyMask why;
  const auto set_if = [&why](Why reason, bool present) {
    if (present) why |= reason;
  };
  set_if(Why::kCameraMissing, !inputs.cameras_present.all());
  set_if(Why::kCamerasUnsynchronized, inputs.cameras_unsynchronized);
  set_if(Why::kOdometryMissing, inputs.odometry_age > limits_.odometry_timeout);
  set_if(Why::kGnssMissing, inputs.gnss_age > limits_.gnss_timeout);
  set_if(Why::kNoInitialPose, !inputs.initialized);
  set_if(Why::kOutsideMap, !inputs.map_nearby);
  set_if(Why::kMatchUncertain, inputs.contradicts_gnss);
  set_if(Why::kMatchRejected, inputs.latest_correction_refused);
  set_if(Why::kPoseUncertain, inputs.longitudinal_sigma_m > limits_.longitudinal_sigma_m ||
                                  inputs.lateral_sigma_m > limits_.lateral_sigma_m ||
                                  inputs.yaw_sigma_rad > limits_.yaw_sigma_rad);
  set_if(Why::kPoseStale, inputs.correction_age > limits_.correction_timeout);
  set_if(Why::kOverload, inputs.overloaded);
  set_if(Why::kInternalFault, inputs.internal_error);
  return why;
}

bool Health::is_lost(const HealthInputs& inputs) const {
  return contradicted_ || why_.has(Why::kPoseUncertain) || why_.has(Why::kOdometryMissing) ||
         inputs.correction_age > limits_.lost_timeout;
}

State Health::next_state(const HealthInputs& inputs) const {
  if (inputs.internal_error) return State::kFault;
  switch (state_) {
    case State::kInit:
      return inputs.initialized ? State::kAcquiring : State::kInit;
    case State::kAcquiring:
      if (contradicted_) return State::kLost;  // what was believed first was wrong: begin again
      return !is_lost(inputs) && inputs.accepted_in_a_row >= limits_.corrections_to_track
                 ? State::kTracking
                 : State::kAcquiring;
    case State::kTracking:
    case State::kDegraded:
      if (is_lost(inputs)) return State::kLost;
      return why_ == can::WhyMask() ? State::kTracking : State::kDegraded;
    case State::kLost:
      return State::kAcquiring;
    case State::kFault:
      return State::kFault;
  }
  return State::kFault;
}

}  // namespace bevloc::firmware
