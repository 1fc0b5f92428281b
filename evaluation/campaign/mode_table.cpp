#include <numbers>
#include <optional>
#include <utility>

#include "evaluation/campaign/mode.h"

namespace bevloc::evaluation {
namespace {

using sim::Fault;
using sim::FaultAmounts;
using sim::FaultKind;

// Indices into kCameraNames.
constexpr int kFront = 1;
constexpr int kBack = 4;

constexpr FaultLength kTwenty{20.0};
constexpr FaultLength kToTheEnd{};
constexpr FaultLength kAlways{.seconds = 0.0, .from_start = true};

// These reasons say that the map does not fit.
const WhyMask kMapContradicts =
    Why::kMatchContradicts | Why::kGnssContradicts | Why::kMatchUncertain;
// These reasons say that the match sees nothing.
const WhyMask kUnseen = Why::kPoseStale | Why::kMatchUncertain;

Fault fault(FaultKind kind, const FaultAmounts& amounts = {}) {
  return {.kind = kind, .amounts = amounts};
}

MatchFault locked(double across_m) {
  return {.kind = MatchFaultKind::kLocked, .offset = {0.0, across_m, 0.0}};
}

/// A fault of one camera, or of two cameras that change places.
Fault fault(FaultKind kind, const FaultAmounts& amounts, int camera,
            std::optional<int> other = std::nullopt) {
  return {.kind = kind, .camera = camera, .other_camera = other, .amounts = amounts};
}

/// Modes with one fault each.
class ModeList {
 public:
  /// `common`: what all modes of the list have in common.
  explicit ModeList(Mode common = {}) : common_(std::move(common)) {}

  void add(std::string_view name, std::string_view what, FaultLength length,
           const Fault& what_fails, WhyMask named_by) {
    add(name, what, length, named_by).faults = {what_fails};
  }
  void add(std::string_view name, std::string_view what, FaultLength length,
           const MatchFault& what_fails, WhyMask named_by) {
    add(name, what, length, named_by).match_faults = {what_fails};
  }

  std::vector<Mode> all() && { return std::move(modes_); }

 private:
  Mode& add(std::string_view name, std::string_view what, FaultLength length, WhyMask named_by) {
    Mode& mode = modes_.emplace_back(common_);
    mode.name = name;
    mode.what = what;
    mode.length = length;
    mode.named_by = named_by;
    return mode;
  }

  Mode common_;
  std::vector<Mode> modes_;
};

/// Modes of GNSS alone, and of GNSS while the match shows less than usual.
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
            fault(FaultKind::kGnssJump, {.across_m = 6.0}), contradicts | Why::kMatchContradicts);
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
  return std::move(modes).all();
}

/// Faults of the matcher, which only the stage level can set at will.
std::vector<Mode> match_modes() {
  const WhyMask contradicts = Why::kMatchContradicts | Why::kMatchUncertain;
  ModeList modes(Mode{.limit_s = 1.0, .on_pictures = false});
  modes.add("match-locked-2m", "match 2 m to the side, from the start", kAlways, locked(2.0),
            contradicts);
  modes.add("match-locked-3m", "match 3 m to the side, from the start", kAlways, locked(3.0),
            contradicts);
  modes.add("match-locked-5m", "match 5 m to the side, from the start", kAlways, locked(5.0),
            contradicts);
  modes.add("match-locked-20m", "match 20 m to the side, from the start", kAlways, locked(20.0),
            contradicts);
  modes.add("match-locked-3m-later", "match 3 m to the side, later", kTwenty, locked(3.0),
            contradicts);
  modes.add("match-locked-1.2m-later", "match 1.2 m to the side, later", kTwenty, locked(1.2),
            contradicts);
  modes.add("match-biased-0.4m", "match 0.4 m to the side (kerb and map differ)", kToTheEnd,
            locked(0.4), {});
  modes.add("match-creeping", "match moves to the side at 0.05 m/s", kToTheEnd,
            MatchFault{.kind = MatchFaultKind::kCreeping, .offset = {0.0, 0.05, 0.0}}, contradicts);
  modes.add("match-creeping-along", "match moves along the road at 0.1 m/s", kToTheEnd,
            MatchFault{.kind = MatchFaultKind::kCreeping, .offset = {0.1, 0.0, 0.0}}, contradicts);
  modes.add("match-no-evidence", "the solver finds nothing for 20 s", kTwenty,
            MatchFault{.kind = MatchFaultKind::kNoEvidence}, Why::kPoseStale);
  modes.add("match-saw-nothing", "the match says nothing (dark cameras)", kTwenty,
            MatchFault{.kind = MatchFaultKind::kSawNothing}, Why::kPoseStale);
  modes.add("match-saw-nothing-start", "the match says nothing, from the start", kAlways,
            MatchFault{.kind = MatchFaultKind::kSawNothing}, Why::kPoseStale);
  modes.add("match-old-stamps", "frames carry times 100 ms too early", kToTheEnd,
            MatchFault{.kind = MatchFaultKind::kOldStamps, .delay_s = 0.1},
            contradicts | Why::kCalibrationFault);
  return std::move(modes).all();
}

/// Faults of the cameras, which only pictures can show.
std::vector<Mode> camera_modes() {
  const WhyMask missing = Why::kCameraMissing;
  const WhyMask calibration = Why::kCalibrationFault;
  ModeList modes(Mode{.on_stage = false});
  modes.add("camera-dead", "no frames from the front camera", kTwenty,
            fault(FaultKind::kCameraDead, {}, kFront), missing);
  modes.add("cameras-dead", "no frames from all cameras", kTwenty, fault(FaultKind::kCameraDead),
            missing | Why::kPoseStale);
  modes.add("cameras-dark", "all cameras dark", kTwenty, fault(FaultKind::kCameraDark),
            missing | Why::kPoseStale);
  modes.add("cameras-dark-start", "all cameras dark, from the start", kAlways,
            fault(FaultKind::kCameraDark), missing | Why::kPoseStale);
  modes.add("cameras-blinded", "all cameras blinded", kTwenty,
            fault(FaultKind::kCameraBlinded, {.strength = 1.0}), missing | Why::kPoseStale);
  modes.add("camera-dirty", "dirt on half of the front camera's lens", kTwenty,
            fault(FaultKind::kCameraDirty, {.share = 0.5}, kFront), missing);
  modes.add("cameras-dirty", "dirt on half of all lenses", kTwenty,
            fault(FaultKind::kCameraDirty, {.share = 0.5}), missing | Why::kPoseStale);
  modes.add("cameras-frozen", "all pictures frozen", kTwenty, fault(FaultKind::kCameraFrozen),
            missing);
  modes.add("cameras-loop", "all cameras repeat four pictures", kTwenty,
            fault(FaultKind::kCameraLoop, {.pictures = 4.0}), missing);
  modes.add("cameras-late", "all frames 500 ms late", kTwenty,
            fault(FaultKind::kCameraLate, {.delay_ms = 500.0}), missing | Why::kPoseStale);
  modes.add("camera-stamps", "all cameras' times 100 ms too early", kToTheEnd,
            fault(FaultKind::kCameraTimeShift, {.shift_ms = -100.0}),
            Why::kCamerasUnsynchronized | Why::kMatchContradicts | Why::kCalibrationFault);
  modes.add("cameras-swapped", "front and back camera swapped, from the start", kAlways,
            fault(FaultKind::kCameraSwapped, {}, kFront, kBack), calibration);
  modes.add("camera-turned-1", "front camera turned by 1 degree", kToTheEnd,
            fault(FaultKind::kCameraTurned, {.yaw_deg = 1.0}, kFront), calibration);
  modes.add("camera-turned-3", "front camera turned by 3 degrees", kToTheEnd,
            fault(FaultKind::kCameraTurned, {.yaw_deg = 3.0}, kFront), calibration);
  modes.add("cameras-turned-1", "all cameras turned by 1 degree", kToTheEnd,
            fault(FaultKind::kCameraTurned, {.yaw_deg = 1.0}), calibration);
  modes.add("cameras-turned-2", "all cameras turned by 2 degrees", kToTheEnd,
            fault(FaultKind::kCameraTurned, {.yaw_deg = 2.0}), calibration);
  return std::move(modes).all();
}

/// Differences between the map and the world. Only pictures can show them. They exist from the
/// start, except for the hole in the map.
std::vector<Mode> map_modes() {
  ModeList modes(Mode{.on_stage = false});
  // The map is shifted to the north-east, so that the vehicle is off the mapped road in any
  // direction.
  const auto shifted = [](double distance_m) {
    const double part_m = distance_m * std::numbers::sqrt2 / 2.0;
    return fault(FaultKind::kMapShifted, {.east_m = part_m, .north_m = part_m});
  };
  modes.add("map-shifted-0.5m", "the map lies 0.5 m off", kAlways, shifted(0.5),
            kMapContradicts | Why::kMapFault);
  modes.add("map-shifted-1m", "the map lies 1 m off", kAlways, shifted(1.0),
            kMapContradicts | Why::kMapFault);
  modes.add("map-shifted-3m", "the map lies 3 m off", kAlways, shifted(3.0),
            kMapContradicts | Why::kMapFault);
  modes.add("map-cut", "the map has a hole along 20 s of the way", kTwenty,
            fault(FaultKind::kMapCut, {.radius_m = 40.0}), kUnseen | Why::kOutsideMap);
  modes.add("map-elsewhere", "the map is that of another town", kAlways,
            fault(FaultKind::kMapOfElsewhere, {.seed = 9.0}), kMapContradicts | kUnseen);
  return std::move(modes).all();
}

/// Visible lines that are not where the map has them, so that the match itself is wrong.
std::vector<Mode> line_modes() {
  ModeList modes(Mode{.limit_s = 1.0, .on_stage = false});
  modes.add("map-border-0.4m", "mapped borders lie 0.4 m outside of the visible ones", kAlways,
            fault(FaultKind::kMapBorderOff, {.outwards_m = 0.4}), kMapContradicts);
  modes.add("grass-inside-2m", "grass grows 2 m into the road", kAlways,
            fault(FaultKind::kWorldGrass, {.inside_m = 2.0}), kMapContradicts | kUnseen);
  return std::move(modes).all();
}

/// Faults of the bus between the vehicle and the appliance.
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

/// Faults of the clocks of the whole appliance. No why bit names a step of the system clock,
/// because it must have no effect.
std::vector<Mode> clock_modes() {
  ModeList modes(Mode{.on_stage = false});
  modes.add("wall-clock-step", "the system clock is set 0.9 s ahead", kToTheEnd,
            fault(FaultKind::kWallClockStep, {.step_s = 0.9}), {});
  modes.add("process-stopped", "the appliance stands still for 3 s", {3.0},
            fault(FaultKind::kClockGap, {.gap_s = 3.0}), Why::kClockGap);
  modes.add("machine-suspended", "the machine is suspended for 3 s, which its clock does not show",
            {1.0}, fault(FaultKind::kClockSuspend, {.gap_s = 3.0}), Why::kClockGap);
  return std::move(modes).all();
}

/// Two faults at once.
std::vector<Mode> combined_modes() {
  const MatchFault alike{.kind = MatchFaultKind::kLanesAlike, .offset = {0.0, 3.5, 0.0}};
  std::vector<Mode> modes;
  modes.push_back({.name = "lanes-alike",
                   .what = "lanes look alike",
                   .length = kAlways,
                   .faults = {},
                   .match_faults = {alike},
                   .on_pictures = false});
  modes.push_back({.name = "lanes-alike-gnss-3m",
                   .what = "lanes look alike, GNSS 3 m off from the start",
                   .length = kAlways,
                   .faults = {fault(FaultKind::kGnssJump, {.across_m = 3.0})},
                   .match_faults = {alike},
                   .named_by = Why::kMatchUncertain | Why::kGnssContradicts,
                   .on_pictures = false});
  modes.push_back(
      {.name = "creeping-without-gnss",
       .what = "match creeps at 0.05 m/s while GNSS is missing",
       .length = kToTheEnd,
       .faults = {fault(FaultKind::kGnssOutage)},
       .match_faults = {{.kind = MatchFaultKind::kCreeping, .offset = {0.0, 0.05, 0.0}}},
       .named_by = Why::kGnssMissing,
       .on_pictures = false});
  modes.push_back({.name = "dark-gnss-drag",
                   .what = "the match says nothing, and GNSS is dragged away at 0.2 m/s",
                   .length = kToTheEnd,
                   .faults = {fault(FaultKind::kGnssRamp, {.across_mps = 0.2})},
                   .match_faults = {{.kind = MatchFaultKind::kSawNothing}},
                   .named_by = Why::kPoseStale,
                   .on_pictures = false});
  modes.push_back({.name = "suspended",
                   .what = "the appliance sleeps for 3 s",
                   .length = {3.0},
                   .faults = {},
                   .match_faults = {},
                   .suspended_s = 3.0,
                   .named_by = Why::kClockGap,
                   .on_pictures = false});
  return modes;
}

}  // namespace

const std::vector<Mode>& all_modes() {
  static const std::vector<Mode> kModes = [] {
    std::vector<Mode> modes;
    modes.push_back({.name = "none",
                     .what = "no fault",
                     .length = {},
                     .faults = {},
                     .match_faults = {},
                     .limit_s = 0.0});
    for (auto* make : {gnss_modes, odometry_modes, match_modes, combined_modes, camera_modes,
                       map_modes, line_modes, bus_modes, clock_modes}) {
      for (Mode& mode : make()) modes.push_back(std::move(mode));
    }
    return modes;
  }();
  return kModes;
}

}  // namespace bevloc::evaluation
