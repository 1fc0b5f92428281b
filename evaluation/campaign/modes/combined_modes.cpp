// Modes with two faults at once, and those of a machine that sleeps.
#include <utility>

#include "evaluation/campaign/modes/mode_list.h"

namespace bevloc::evaluation {

using sim::FaultKind;

namespace {

// In each mode only the reasons count that name its second fault.
constexpr WhyMask kOdometryNamed = Why::kOdometryContradicts | Why::kOdometryImplausible;

}  // namespace

std::vector<Mode> modes_without_gnss() {
  const sim::Fault outage = fault(FaultKind::kGnssOutage);
  const MatchFault creeping{.kind = MatchFaultKind::kCreeping, .offset = {0.0, 0.05, 0.0}};
  ModeList modes(Mode{.on_pictures = false});
  modes.add("creeping-without-gnss", "match creeps at 0.05 m/s while GNSS is missing", kToTheEnd,
            {outage}, {creeping}, Why::kMatchContradicts | Why::kMatchUncertain);
  modes.add("odometry-stuck-without-gnss", "odometry repeats its values while GNSS is missing",
            kTwenty, {outage, fault(FaultKind::kOdometryStuck)}, {}, kOdometryNamed);
  modes.add("odometry-spin-without-gnss", "speed x 1.3 while GNSS is missing", kTwenty,
            {outage, fault(FaultKind::kOdometrySlip, {.factor = 1.3})}, {}, kOdometryNamed);
  modes.add("odometry-scale-without-gnss", "wheel speed 2 % too high while GNSS is missing",
            kToTheEnd, {outage, fault(FaultKind::kOdometryScaled, {.factor = 1.02})}, {},
            kOdometryNamed);
  modes.add("yaw-bias-3-without-gnss", "yaw rate 3 degrees/s too high while GNSS is missing",
            kTwenty, {outage, fault(FaultKind::kYawRateBias, {.bias_degps = 3.0})}, {},
            kOdometryNamed);
  return std::move(modes).all();
}

std::vector<Mode> modes_without_match() {
  const MatchFault dark{.kind = MatchFaultKind::kSawNothing};
  ModeList modes(Mode{.on_pictures = false});
  modes.add("dark-gnss-drag", "the match says nothing, and GNSS is dragged away at 0.2 m/s",
            kToTheEnd, {fault(FaultKind::kGnssRamp, {.across_mps = 0.2})}, {dark},
            Why::kGnssContradicts);
  modes.add("dark-odometry-scale", "the match says nothing, and the wheel speed is 2 % too high",
            kToTheEnd, {fault(FaultKind::kOdometryScaled, {.factor = 1.02})}, {dark},
            kOdometryNamed);
  return std::move(modes).all();
}

std::vector<Mode> lane_modes() {
  const MatchFault alike{.kind = MatchFaultKind::kLanesAlike, .offset = {0.0, 3.5, 0.0}};
  ModeList modes(Mode{.on_pictures = false});
  modes.add("lanes-alike", "lanes look alike", kAlways, alike, {});
  modes.add("lanes-alike-gnss-3m", "lanes look alike, GNSS 3 m off from the start", kAlways,
            {fault(FaultKind::kGnssJump, {.across_m = 3.0})}, {alike},
            Why::kMatchUncertain | Why::kGnssContradicts);
  return std::move(modes).all();
}

std::vector<Mode> sleep_modes() {
  ModeList modes(Mode{.suspended_s = 3.0, .on_pictures = false});
  modes.add("suspended", "the appliance sleeps for 3 s", {3.0}, {}, {}, Why::kClockGap);
  modes.add("suspended-gnss-20m", "the appliance sleeps for 3 s; GNSS is then 20 m off", kTwenty,
            {fault(FaultKind::kGnssJump, {.across_m = 20.0})}, {}, Why::kClockGap);
  modes.add("suspended-gnss-3m", "the appliance sleeps for 3 s; GNSS is then 3 m off", kTwenty,
            {fault(FaultKind::kGnssJump, {.across_m = 3.0})}, {}, Why::kClockGap);
  return std::move(modes).all();
}

}  // namespace bevloc::evaluation
