// Modes of what the vehicle sends, of the bus, and of the clocks.
#include <utility>

#include "evaluation/campaign/modes/mode_list.h"

namespace bevloc::evaluation {

using sim::FaultKind;

std::vector<Mode> gnss_modes() {
  const WhyMask contradicts = Why::kGnssContradicts;
  ModeList modes;
  modes.add("gnss-outage", "GNSS missing for 20 s", kTwenty, fault(FaultKind::kGnssOutage),
            Why::kGnssMissing);
  modes.add("gnss-jump-3m", "GNSS 3 m off to the side", kTwenty,
            fault(FaultKind::kGnssJump, {.across_m = 3.0}), contradicts);
  modes.add("gnss-jump-20m", "GNSS 20 m off to the side", kTwenty,
            fault(FaultKind::kGnssJump, {.across_m = 20.0}), contradicts);
  modes.add("gnss-jump-200m", "GNSS 200 m off", kTwenty,
            fault(FaultKind::kGnssJump, {.along_m = 200.0}), contradicts);
  modes.add("gnss-spoof-20m", "GNSS pulled away by 20 m within 5 s", kTwenty,
            fault(FaultKind::kGnssSpoof, {.across_m = 20.0, .pull_s = 5.0}), contradicts);
  modes.add("gnss-drag", "GNSS dragged along the road at 0.1 m/s", kToTheEnd,
            fault(FaultKind::kGnssRamp, {.along_mps = 0.1}), contradicts);
  modes.add("gnss-wrong-sigma", "GNSS claims a tenth of its sigma", kToTheEnd,
            fault(FaultKind::kGnssWrongSigma, {.factor = 0.1}), contradicts);
  modes.add("gnss-noise", "GNSS five times as noisy as it claims", kTwenty,
            fault(FaultKind::kGnssNoise, {.factor = 5.0}), contradicts);
  modes.add("gnss-no-heading", "GNSS without heading", kToTheEnd, fault(FaultKind::kGnssNoHeading),
            {});
  modes.add("gnss-no-heading-start", "GNSS without heading from the start", kAlways,
            fault(FaultKind::kGnssNoHeading), {});
  modes.add("gnss-start-6m", "GNSS 6 m off from the start", kAlways,
            fault(FaultKind::kGnssJump, {.across_m = 6.0}),
            contradicts | Why::kMatchContradicts | Why::kMatchUncertain);
  modes.add("gnss-outage-start", "GNSS missing for the first 20 s", {20.0, true},
            fault(FaultKind::kGnssOutage), {});
  modes.add("gnss-stuck", "GNSS repeats its last fix", kTwenty, fault(FaultKind::kGnssStuck),
            contradicts);
  modes.add("gnss-late", "GNSS fixes are 1 s old", kTwenty,
            fault(FaultKind::kGnssLate, {.delay_ms = 1000.0}), contradicts);
  modes.add("gnss-late-start", "GNSS fixes are 0.5 s old, from the start", kAlways,
            fault(FaultKind::kGnssLate, {.delay_ms = 500.0}), contradicts);
  modes.add("gnss-heading-10", "GNSS heading 10 degrees off", kTwenty,
            fault(FaultKind::kGnssJump, {.heading_deg = 10.0}), contradicts);
  modes.add("gnss-heading-10-start", "GNSS heading 10 degrees off from the start", kAlways,
            fault(FaultKind::kGnssJump, {.heading_deg = 10.0}), contradicts | Why::kMatchUncertain);
  return std::move(modes).all();
}

std::vector<Mode> odometry_modes() {
  const WhyMask contradicts = Why::kOdometryContradicts | Why::kOdometryImplausible;
  ModeList modes;
  modes.add("odometry-stuck", "odometry repeats its values, with valid E2E", kTwenty,
            fault(FaultKind::kOdometryStuck), contradicts);
  modes.add("odometry-spin", "wheels spin, speed x 1.3 for 2 s", {2.0},
            fault(FaultKind::kOdometrySlip, {.factor = 1.3}), contradicts);
  modes.add("odometry-lock", "wheels lock, speed x 0.3 for 1.5 s", {1.5},
            fault(FaultKind::kOdometryLock, {.factor = 0.3}), contradicts);
  modes.add("odometry-scale", "wheel speed 2 % too high", kToTheEnd,
            fault(FaultKind::kOdometryScaled, {.factor = 1.02}), contradicts);
  modes.add("odometry-reversed", "wheel speeds with the wrong sign", kTwenty,
            fault(FaultKind::kOdometryReversed), contradicts);
  modes.add("odometry-missing", "no odometry for 5 s", {5.0}, fault(FaultKind::kOdometryMissing),
            Why::kOdometryMissing);
  modes.add("odometry-slow", "odometry every 180 ms", kTwenty,
            fault(FaultKind::kOdometrySlow, {.period_ms = 180.0}),
            contradicts | Why::kOdometryMissing);
  modes.add("odometry-wheels-differ", "rear wheels +80 and -80 km/h", {5.0},
            fault(FaultKind::kOdometryWheels, {.left_mps = 22.2, .right_mps = -22.2}), contradicts);
  modes.add("odometry-one-wheel", "left wheel 20 km/h, right wheel 0", {5.0},
            fault(FaultKind::kOdometryWheels, {.left_mps = 5.6}), contradicts);
  modes.add("yaw-bias-1", "yaw rate 1 degree/s too high", kTwenty,
            fault(FaultKind::kYawRateBias, {.bias_degps = 1.0}), contradicts);
  modes.add("yaw-bias-3", "yaw rate 3 degrees/s too high", kTwenty,
            fault(FaultKind::kYawRateBias, {.bias_degps = 3.0}), contradicts);
  modes.add("yaw-rate-sign", "yaw rate with the wrong sign", kTwenty,
            fault(FaultKind::kYawRateScaled, {.factor = -1.0}), contradicts);
  modes.add("yaw-rate-160", "yaw rate 160 degrees/s", {5.0},
            fault(FaultKind::kYawRateWrong, {.yaw_rate_degps = 160.0}), contradicts);
  modes.add("odometry-late", "odometry is 200 ms old", kTwenty,
            fault(FaultKind::kOdometryLate, {.delay_ms = 200.0}),
            contradicts | Why::kCalibrationFault);
  return std::move(modes).all();
}

std::vector<Mode> bus_modes() {
  const WhyMask foreign =
      Why::kForeignSender | Why::kOdometryImplausible | Why::kOdometryContradicts;
  ModeList modes;
  modes.add("bus-off", "the controller is bus-off for 5 s", {5.0}, fault(FaultKind::kBusOff),
            Why::kOdometryMissing);
  modes.add("bus-no-acknowledge", "no node acknowledges for 5 s; 20 old frames follow", {5.0},
            fault(FaultKind::kBusNoAcknowledge, {.stale_frames = 20.0}), Why::kOdometryMissing);
  modes.add("bus-flooded", "a flood takes the place of 90 % of the frames", {5.0},
            fault(FaultKind::kBusFlooded, {.rate_hz = 4000.0, .loss = 0.9}), Why::kOdometryMissing);
  modes.add("bus-forged", "another node sends odometry of 20 m/s too", kTwenty,
            fault(FaultKind::kBusForged, {.speed_mps = 20.0, .counter_step = 5.0}), foreign);
  modes.add("bus-replayed", "another node repeats frames of 5 s ago", kTwenty,
            fault(FaultKind::kBusReplayed, {.age_s = 5.0}), foreign);
  return std::move(modes).all();
}

std::vector<Mode> clock_modes() {
  // The appliance's clock does not show the suspension, so it ends as soon as it has begun.
  constexpr FaultLength kAtOnce{0.01};
  ModeList modes(Mode{.on_stage = false});
  modes.add("wall-clock-step", "the system clock is set 0.9 s ahead", kToTheEnd,
            fault(FaultKind::kWallClockStep, {.step_s = 0.9}), {});
  modes.add("process-stopped", "the appliance stands still for 3 s", {3.0},
            fault(FaultKind::kClockGap, {.gap_s = 3.0}), Why::kClockGap);
  modes.add("machine-suspended", "the machine is suspended for 3 s, which its clock does not show",
            kAtOnce, fault(FaultKind::kClockSuspend, {.gap_s = 3.0}), Why::kClockGap);
  modes.add("machine-suspended-briefly", "the machine is suspended for 0.25 s", kAtOnce,
            fault(FaultKind::kClockSuspend, {.gap_s = 0.25}), Why::kClockGap);
  return std::move(modes).all();
}

}  // namespace bevloc::evaluation
