#include "firmware/status/telemetry.h"

namespace bevloc::firmware {
namespace {

/// A supervisor that is silent for longer hangs, because it hands over a new value every 100 ms.
constexpr Duration kSilentSupervisor = std::chrono::seconds(2);
/// A pose that is older shows that its thread hangs, because it is predicted to a new time every
/// bus cycle.
constexpr Duration kOldPose = std::chrono::seconds(2);

/// A lost pose is usually found again within this time.
constexpr Duration kLostGrace = std::chrono::seconds(10);

/// With one of these reasons the daemon cannot become ready by itself, so somebody has to act.
constexpr WhyMask kNeedsHelp =
    Why::kCameraMissing | Why::kCamerasUnsynchronized | Why::kOdometryMissing | Why::kGnssMissing |
    Why::kOutsideMap | Why::kMapFault | Why::kCalibrationFault | Why::kNetworkFault |
    Why::kInternalFault | Why::kForeignSender | Why::kOdometryImplausible;

std::string reasons_with_advice(WhyMask why) {
  std::string text;
  for_each_reason(why, [&](Why reason) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : " ", words_of(reason), advice_for(reason));
  });
  return text;
}

}  // namespace

std::string words_of(Why why) {
  return to_string(WhyMask(why));
}

/// The switch has no default, so that the compiler warns when a reason has no advice.
const char* advice_for(Why why) {
  switch (why) {
    case Why::kCameraMissing:
      return "Look for the camera without usable frames; check its cable and its power.";
    case Why::kCamerasUnsynchronized:
      return "Check the trigger line and that every camera is in trigger mode; without a trigger, "
             "use compensate_motion with a wide tolerance_ms.";
    case Why::kOdometryMissing:
      return "Check that wheel speed and yaw rate arrive, pass the E2E check and are not SNA.";
    case Why::kGnssMissing:
      return "Check the antenna, and that GNSS arrives (on the bus, or from gpsd: bevloc status).";
    case Why::kNoInitialPose:
      return "Wait for odometry and GNSS (on the bus, or from gpsd: bevloc status); without a GNSS "
             "heading, drive some 10 m.";
    case Why::kOutsideMap:
      return "Check that the map covers this place and that its origin is right.";
    case Why::kMatchUncertain:
      return "Drive on; if the reason stays, compare the map's origin with the GNSS position.";
    case Why::kMatchRejected:
      return "Check the calibration of the cameras and the scale of the wheel speed.";
    case Why::kPoseUncertain:
      return "Drive on to where the road has markings; if the reason stays, check the odometry.";
    case Why::kPoseStale:
      return "See the other reasons; if there is none, the cameras see nothing that the map has.";
    case Why::kPoseInvalid:
      return "Send the journal to the developers and restart the service.";
    case Why::kOverload:
      return "Give the vision thread more CPU time: see the section realtime.";
    case Why::kMapFault:
      return "GNSS and map lie apart: check the map's datum and origin, and the place of the GNSS "
             "antenna.";
    case Why::kCalibrationFault:
      return "A camera is not where the calibration says, or the time stamps are wrong; the log "
             "says which: check its mount or the clocks.";
    case Why::kNetworkFault:
      return "The network computes wrong results: restart; if the reason returns, replace the "
             "computer.";
    case Why::kInternalFault:
      return "Send the journal to the developers and restart the service.";
    case Why::kGnssContradicts:
      return "Check the antenna's position, and the delay of GNSS if the log names one; a "
             "disturbance by buildings or a tunnel ends by itself.";
    case Why::kOdometryContradicts:
      return "Check the wheel speed and the yaw rate; the slip of a wheel ends by itself.";
    case Why::kMatchContradicts:
      return "Check that map and calibration belong to this place and this vehicle.";
    case Why::kClockGap:
      return "The machine was suspended; the pose is found again by itself.";
    case Why::kOdometryImplausible:
      return "Check the wheel speeds and the yaw rate that the vehicle sends.";
    case Why::kForeignSender:
      return "Find the node that sends with identifiers of this daemon or of the vehicle.";
  }
  return "";
}

bool pose_is_valid(const Telemetry& telemetry, Duration age) {
  const PoseSnapshot& pose = telemetry.snapshot.estimation.pose;
  return telemetry.phase == Phase::kRunning && pose.valid && age <= kSilentSupervisor &&
         telemetry.time - pose.time + age <= kOldPose;
}

HealthCheck check_health(const Telemetry& telemetry, Duration age) {
  if (telemetry.phase == Phase::kStarting) return {true, "starting"};
  if (telemetry.phase == Phase::kStandby) return {true, "standby: ignition off"};
  if (age > kSilentSupervisor) {
    return {false, fmt::format("the supervisor has said nothing for {:.0f} s. Restart the service.",
                               to_seconds(age))};
  }
  if (!telemetry.view.hung.empty()) {
    return {false, fmt::format("a thread hangs: {}. Restart the service.", telemetry.view.hung)};
  }
  const EstimationSnapshot& estimation = telemetry.snapshot.estimation;
  const std::string help = reasons_with_advice(estimation.why);
  const Time invalid_since = estimation.invalid_since;
  const bool stays_lost =
      telemetry.time > invalid_since && telemetry.time - invalid_since > kLostGrace;
  const std::string since = stays_lost ? fmt::format(", no valid pose for {:.0f} s",
                                                     to_seconds(telemetry.time - invalid_since))
                                       : "";
  const std::string text =
      fmt::format("{}{}{}{}", to_string(estimation.state), since, help.empty() ? "" : ": ", help);
  switch (estimation.state) {
    case HealthState::kTracking:
    case HealthState::kDegraded:
      return {true, text};
    case HealthState::kLost:
    case HealthState::kFault:
      return {false, text};
    case HealthState::kInit:
    case HealthState::kAcquiring:
      break;
  }
  return {!stays_lost && (estimation.why.bits() & kNeedsHelp.bits()) == 0, text};
}

}  // namespace bevloc::firmware
