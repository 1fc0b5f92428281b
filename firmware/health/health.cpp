#include "firmware/health/health.h"

#include <algorithm>
#include <utility>

#include "can/publisher/solution_frames.h"

namespace bevloc::firmware {
namespace {

/// A new pose becomes valid only if this many standard deviations lie within the alert limits.
constexpr double kSigmasToTrack = 4.0;
/// A pose without matches is trusted for this long, unless match or GNSS is excluded. In drives
/// without a fault, shorter times without a match are common.
constexpr Duration kTrustedDeadReckoning = std::chrono::seconds(3);
/// A pose counts as new for kNewPose. Without matches it is trusted for kTrustedNewPose only,
/// because the filter does not know the bias of the yaw rate yet.
constexpr Duration kNewPose = std::chrono::seconds(5);
constexpr Duration kTrustedNewPose = std::chrono::seconds(2);
/// The publisher sends no pose whose images are older than this. So state, log and bus agree.
constexpr Duration kOldestMatch = can::kMaxCaptureAge;

}  // namespace

bool Health::update(const HealthInputs& inputs) {
  why_ = find_reasons(inputs);
  const HealthState before = std::exchange(state_, next_state(inputs));
  return state_ != before;
}

WhyMask Health::find_reasons(const HealthInputs& inputs) const {
  WhyMask why;
  const auto set_if = [&why](Why reason, bool present) {
    if (present) why |= reason;
  };
  set_if(Why::kCameraMissing, !inputs.cameras_present.all());
  set_if(Why::kCamerasUnsynchronized, inputs.cameras_unsynchronized);
  set_if(Why::kOdometryMissing, inputs.odometry_age > limits_.odometry_timeout);
  set_if(Why::kGnssMissing, inputs.gnss_age > limits_.gnss_timeout);
  set_if(Why::kNoInitialPose, !inputs.initialized);
  set_if(Why::kOutsideMap, !inputs.map_nearby);
  set_if(Why::kMatchUncertain,
         inputs.verdict.undecided || (!pose_valid() && !has_enough_matches(inputs)));
  set_if(Why::kGnssContradicts, inputs.verdict.gnss_contradicts || inputs.gnss_lags);
  set_if(Why::kOdometryContradicts, inputs.verdict.odometry_contradicts);
  set_if(Why::kMatchContradicts, inputs.verdict.match_contradicts);
  set_if(Why::kMapFault, inputs.verdict.map_contradicts);
  set_if(Why::kOdometryImplausible, inputs.odometry_implausible);
  set_if(Why::kForeignSender, inputs.foreign_sender);
  set_if(Why::kClockGap, inputs.clock_gap);
  set_if(Why::kMatchRejected, inputs.latest_correction_refused);
  set_if(Why::kPoseUncertain,
         is_too_uncertain(inputs) || (!pose_valid() && !is_within_alert_limits(inputs)));
  set_if(Why::kPoseStale, inputs.correction_age > limits_.correction_timeout);
  set_if(Why::kOverload, inputs.overloaded);
  set_if(Why::kNetworkFault, inputs.network_fault);
  set_if(Why::kCalibrationFault, inputs.calibration_fault || inputs.stamps_contradict);
  set_if(Why::kInternalFault, inputs.internal_error);
  return why;
}

bool Health::is_lost(const HealthInputs& inputs) const {
  const bool contradicted =
      inputs.verdict.odometry_contradicts ||
      (inputs.verdict.undecided && inputs.refused_in_a_row >= limits_.refusals_to_lose);
  return contradicted || inputs.verdict.map_contradicts || inputs.stamps_contradict ||
         inputs.gnss_lags || !inputs.initialized || inputs.odometry_implausible ||
         inputs.clock_gap || is_too_uncertain(inputs) || why_.has(Why::kOdometryMissing) ||
         inputs.correction_age > limits_.lost_timeout || inputs.match_age > kOldestMatch;
}

bool Health::is_too_uncertain(const HealthInputs& inputs) const {
  return is_unprotected(inputs) || inputs.longitudinal_sigma_m > limits_.longitudinal_sigma_m ||
         inputs.lateral_sigma_m > limits_.lateral_sigma_m ||
         inputs.yaw_sigma_rad > limits_.yaw_sigma_rad;
}

/// Whether the pose has come from dead reckoning for too long and its error may exceed the alert
/// limits.
bool Health::is_unprotected(const HealthInputs& inputs) const {
  const bool disputed = inputs.verdict.match_contradicts || inputs.verdict.gnss_excluded;
  const bool is_new = inputs.valid_age < kNewPose;
  const Duration undisputed = is_new ? kTrustedNewPose : kTrustedDeadReckoning;
  const Duration trusted = disputed ? std::min(limits_.correction_timeout, undisputed) : undisputed;
  return inputs.correction_age > trusted &&
         (inputs.protection_level.y() > limits_.alert_limit.y() ||
          inputs.protection_level.z() > limits_.alert_limit.z());
}

bool Health::has_enough_matches(const HealthInputs& inputs) const {
  return inputs.start_confirmed && inputs.accepted_in_a_row >= limits_.corrections_to_track;
}

bool Health::is_within_alert_limits(const HealthInputs& inputs) const {
  const Eigen::Array3d sigma(inputs.longitudinal_sigma_m, inputs.lateral_sigma_m,
                             inputs.yaw_sigma_rad);
  return (kSigmasToTrack * sigma <= limits_.alert_limit.array()).all();
}

bool Health::is_confirmed(const HealthInputs& inputs) const {
  return has_enough_matches(inputs) && is_within_alert_limits(inputs);
}

HealthState Health::next_state(const HealthInputs& inputs) const {
  if (inputs.internal_error || inputs.network_fault) return HealthState::kFault;
  switch (state_) {
    case HealthState::kInit:
      return inputs.initialized ? HealthState::kAcquiring : HealthState::kInit;
    case HealthState::kAcquiring:
      return !is_lost(inputs) && is_confirmed(inputs) ? HealthState::kTracking
                                                      : HealthState::kAcquiring;
    case HealthState::kTracking:
    case HealthState::kDegraded:
      if (is_lost(inputs)) return HealthState::kLost;
      return why_ == WhyMask() ? HealthState::kTracking : HealthState::kDegraded;
    case HealthState::kLost:
      return HealthState::kAcquiring;
    case HealthState::kFault:
      return HealthState::kFault;
  }
  return HealthState::kFault;
}

}  // namespace bevloc::firmware
