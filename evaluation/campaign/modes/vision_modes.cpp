// Modes of the cameras, the map and the match.
#include <numbers>
#include <utility>

#include "evaluation/campaign/modes/mode_list.h"

namespace bevloc::evaluation {

using sim::FaultKind;

namespace {

// Indices into kCameraNames.
constexpr int kFront = 1;
constexpr int kBack = 4;

// These reasons say that the map does not fit.
const WhyMask kMapContradicts =
    Why::kMatchContradicts | Why::kGnssContradicts | Why::kMatchUncertain;
// These reasons say that the match sees nothing.
const WhyMask kUnseen = Why::kPoseStale | Why::kMatchUncertain;

}  // namespace

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
  modes.add("match-locked-3m-without-gnss", "match 3 m to the side while GNSS is missing", kTwenty,
            {fault(FaultKind::kGnssOutage)}, {locked(3.0)}, contradicts);
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

std::vector<Mode> line_modes() {
  ModeList modes(Mode{.limit_s = 1.0, .on_stage = false});
  modes.add("map-border-0.4m", "mapped borders lie 0.4 m outside of the visible ones", kAlways,
            fault(FaultKind::kMapBorderOff, {.outwards_m = 0.4}), kMapContradicts);
  modes.add("grass-inside-2m", "grass grows 2 m into the road", kAlways,
            fault(FaultKind::kWorldGrass, {.inside_m = 2.0}), kMapContradicts | kUnseen);
  return std::move(modes).all();
}

}  // namespace bevloc::evaluation
