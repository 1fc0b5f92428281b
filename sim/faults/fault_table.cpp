#include "sim/faults/fault_table.h"

#include <array>

namespace bevloc::sim {
namespace {

using A = FaultAmounts;

constexpr double kFar_m = 100'000.0;
constexpr double kFast_mps = 80.0;

constexpr AmountInfo kOffset[] = {{"east_m", &A::east_m, -kFar_m, kFar_m, 0.0},
                                  {"north_m", &A::north_m, -kFar_m, kFar_m, 0.0},
                                  {"along_m", &A::along_m, -kFar_m, kFar_m, 0.0},
                                  {"across_m", &A::across_m, -kFar_m, kFar_m, 0.0},
                                  {"heading_deg", &A::heading_deg, -180.0, 180.0, 0.0}};
constexpr AmountInfo kDrift[] = {{"east_mps", &A::east_mps, -kFast_mps, kFast_mps, 0.0},
                                 {"north_mps", &A::north_mps, -kFast_mps, kFast_mps, 0.0},
                                 {"along_mps", &A::along_mps, -kFast_mps, kFast_mps, 0.0},
                                 {"across_mps", &A::across_mps, -kFast_mps, kFast_mps, 0.0}};
constexpr AmountInfo kPulledOffset[] = {{"east_m", &A::east_m, -kFar_m, kFar_m, 0.0},
                                        {"north_m", &A::north_m, -kFar_m, kFar_m, 0.0},
                                        {"along_m", &A::along_m, -kFar_m, kFar_m, 0.0},
                                        {"across_m", &A::across_m, -kFar_m, kFar_m, 0.0},
                                        {"pull_s", &A::pull_s, 0.0, 3600.0, 5.0}};
constexpr AmountInfo kPositiveFactor[] = {{"factor", &A::factor, 0.0, 1000.0}};
constexpr AmountInfo kSignedFactor[] = {{"factor", &A::factor, -100.0, 100.0}};
constexpr AmountInfo kSlip[] = {{"factor", &A::factor, 1.0, 100.0, 1.3}};
constexpr AmountInfo kLock[] = {{"factor", &A::factor, 0.0, 1.0, 0.3}};
constexpr AmountInfo kPeriod[] = {{"period_ms", &A::period_ms, 20.0, 60'000.0}};
constexpr AmountInfo kWheels[] = {{"left_mps", &A::left_mps, -kFast_mps, kFast_mps},
                                  {"right_mps", &A::right_mps, -kFast_mps, kFast_mps}};
constexpr AmountInfo kBias[] = {{"bias_degps", &A::bias_degps, -160.0, 160.0}};
constexpr AmountInfo kYawRate[] = {{"yaw_rate_degps", &A::yaw_rate_degps, -163.0, 163.0}};
constexpr AmountInfo kPictures[] = {{"pictures", &A::pictures, 1.0, 10'000.0, 4.0, true}};
constexpr AmountInfo kDelay[] = {{"delay_ms", &A::delay_ms, 0.0, 60'000.0}};
constexpr AmountInfo kEvery[] = {{"every", &A::every, 2.0, 1'000'000.0, std::nullopt, true}};
constexpr AmountInfo kShift[] = {{"shift_ms", &A::shift_ms, -60'000.0, 60'000.0}};
constexpr AmountInfo kBrightness[] = {{"brightness", &A::brightness, 0.0, 1.0, 0.0}};
constexpr AmountInfo kStrength[] = {{"strength", &A::strength, 0.0, 1.0, 1.0}};
constexpr AmountInfo kShare[] = {{"share", &A::share, 0.0, 1.0, 0.4}};
constexpr AmountInfo kTurn[] = {{"yaw_deg", &A::yaw_deg, -180.0, 180.0, 0.0},
                                {"pitch_deg", &A::pitch_deg, -180.0, 180.0, 0.0},
                                {"roll_deg", &A::roll_deg, -180.0, 180.0, 0.0}};
constexpr AmountInfo kMove[] = {{"x_m", &A::x_m, -10.0, 10.0, 0.0},
                                {"y_m", &A::y_m, -10.0, 10.0, 0.0},
                                {"z_m", &A::z_m, -1.0, 10.0, 0.0}};

constexpr AmountInfo kMapShift[] = {{"east_m", &A::east_m, -kFar_m, kFar_m, 0.0},
                                    {"north_m", &A::north_m, -kFar_m, kFar_m, 0.0},
                                    {"yaw_deg", &A::yaw_deg, -180.0, 180.0, 0.0}};
constexpr AmountInfo kRadius[] = {{"radius_m", &A::radius_m, 1.0, 1000.0, 40.0}};
constexpr AmountInfo kSeed[] = {{"seed", &A::seed, 0.0, 1e9, std::nullopt, true}};
constexpr AmountInfo kOutwards[] = {{"outwards_m", &A::outwards_m, -5.0, 5.0}};
constexpr AmountInfo kInside[] = {{"inside_m", &A::inside_m, 0.0, 10.0, 2.0}};
constexpr AmountInfo kGap[] = {{"gap_s", &A::gap_s, 0.0, 3600.0}};
constexpr AmountInfo kStep[] = {{"step_s", &A::step_s, -1e6, 1e6}};
constexpr AmountInfo kStale[] = {{"stale_frames", &A::stale_frames, 0.0, 1000.0, 0.0, true}};
constexpr AmountInfo kFlood[] = {{"rate_hz", &A::rate_hz, 0.0, 10'000.0, 4000.0},
                                 {"loss", &A::loss, 0.0, 1.0, 0.9}};
constexpr AmountInfo kForgery[] = {{"speed_mps", &A::speed_mps, -kFast_mps, kFast_mps},
                                   {"yaw_rate_degps", &A::yaw_rate_degps, -163.0, 163.0, 0.0},
                                   {"counter_step", &A::counter_step, 1.0, 15.0, 5.0, true}};
constexpr AmountInfo kAge[] = {{"age_s", &A::age_s, 0.1, 60.0, 5.0}};

using K = FaultKind;
using I = FaultInput;

constexpr std::array kKinds = {
    FaultKindInfo{K::kGnssJump, "gnss_jump", I::kGnss, kOffset},
    FaultKindInfo{K::kGnssRamp, "gnss_ramp", I::kGnss, kDrift},
    FaultKindInfo{K::kGnssSpoof, "gnss_spoof", I::kGnss, kPulledOffset},
    FaultKindInfo{K::kGnssNoise, "gnss_noise", I::kGnss, kPositiveFactor},
    FaultKindInfo{K::kGnssWrongSigma, "gnss_wrong_sigma", I::kGnss, kPositiveFactor},
    FaultKindInfo{K::kGnssNoHeading, "gnss_no_heading", I::kGnss, {}},
    FaultKindInfo{K::kGnssOutage, "gnss_outage", I::kGnss, {}},
    FaultKindInfo{K::kGnssStuck, "gnss_stuck", I::kGnss, {}},
    FaultKindInfo{K::kGnssLate, "gnss_late", I::kGnss, kDelay},
    FaultKindInfo{K::kOdometryStuck, "odometry_stuck", I::kOdometry, {}},
    FaultKindInfo{K::kOdometryScaled, "odometry_scaled", I::kOdometry, kPositiveFactor},
    FaultKindInfo{K::kOdometrySlip, "odometry_slip", I::kOdometry, kSlip},
    FaultKindInfo{K::kOdometryLock, "odometry_lock", I::kOdometry, kLock},
    FaultKindInfo{K::kOdometryReversed, "odometry_reversed", I::kOdometry, {}},
    FaultKindInfo{K::kOdometrySlow, "odometry_slow", I::kOdometry, kPeriod},
    FaultKindInfo{K::kOdometryLate, "odometry_late", I::kOdometry, kDelay},
    FaultKindInfo{K::kOdometryMissing, "odometry_missing", I::kOdometry, {}},
    FaultKindInfo{K::kOdometryWheels, "odometry_wheels", I::kOdometry, kWheels},
    FaultKindInfo{K::kYawRateBias, "yaw_rate_bias", I::kOdometry, kBias},
    FaultKindInfo{K::kYawRateScaled, "yaw_rate_scaled", I::kOdometry, kSignedFactor},
    FaultKindInfo{K::kYawRateWrong, "yaw_rate_wrong", I::kOdometry, kYawRate},
    FaultKindInfo{K::kCameraDead, "camera_dead", I::kCamera, {}},
    FaultKindInfo{K::kCameraFrozen, "camera_frozen", I::kCamera, {}},
    FaultKindInfo{K::kCameraLoop, "camera_loop", I::kCamera, kPictures},
    FaultKindInfo{K::kCameraLate, "camera_late", I::kCamera, kDelay},
    FaultKindInfo{K::kCameraDrop, "camera_drop", I::kCamera, kEvery},
    FaultKindInfo{K::kCameraDuplicate, "camera_duplicate", I::kCamera, kEvery},
    FaultKindInfo{K::kCameraOutOfOrder, "camera_out_of_order", I::kCamera, kEvery},
    FaultKindInfo{K::kCameraTimeShift, "camera_time_shift", I::kCamera, kShift},
    FaultKindInfo{K::kCameraDark, "camera_dark", I::kCamera, kBrightness},
    FaultKindInfo{K::kCameraBlinded, "camera_blinded", I::kCamera, kStrength},
    FaultKindInfo{K::kCameraDirty, "camera_dirty", I::kCamera, kShare},
    FaultKindInfo{K::kCameraSwapped, "camera_swapped", I::kCamera, {}},
    FaultKindInfo{K::kCameraTurned, "camera_turned", I::kCamera, kTurn},
    FaultKindInfo{K::kCameraMoved, "camera_moved", I::kCamera, kMove},
    FaultKindInfo{K::kMapShifted, "map_shifted", I::kMap, kMapShift},
    FaultKindInfo{K::kMapCut, "map_cut", I::kMap, kRadius},
    FaultKindInfo{K::kMapOfElsewhere, "map_of_elsewhere", I::kMap, kSeed},
    FaultKindInfo{K::kMapBorderOff, "map_border_off", I::kMap, kOutwards},
    FaultKindInfo{K::kWorldGrass, "world_grass", I::kMap, kInside},
    FaultKindInfo{K::kClockGap, "clock_gap", I::kClock, kGap},
    FaultKindInfo{K::kClockSuspend, "clock_suspend", I::kClock, kGap},
    FaultKindInfo{K::kWallClockStep, "wall_clock_step", I::kClock, kStep},
    FaultKindInfo{K::kBusOff, "bus_off", I::kBus, {}},
    FaultKindInfo{K::kBusNoAcknowledge, "bus_no_acknowledge", I::kBus, kStale},
    FaultKindInfo{K::kBusFlooded, "bus_flooded", I::kBus, kFlood},
    FaultKindInfo{K::kBusForged, "bus_forged", I::kBus, kForgery},
    FaultKindInfo{K::kBusReplayed, "bus_replayed", I::kBus, kAge},
    FaultKindInfo{K::kHangCapture, "hang_capture", I::kThread, {}},
    FaultKindInfo{K::kHangVision, "hang_vision", I::kThread, {}},
    FaultKindInfo{K::kHangCanIn, "hang_can_in", I::kThread, {}},
    FaultKindInfo{K::kHangCanOut, "hang_can_out", I::kThread, {}},
};

/// info_of() looks kinds up by their number.
constexpr bool is_ordered() {
  for (size_t i = 0; i < kKinds.size(); ++i) {
    if (static_cast<size_t>(kKinds[i].kind) != i) return false;
  }
  return true;
}
static_assert(is_ordered());

}  // namespace

std::span<const FaultKindInfo> fault_kinds() {
  return kKinds;
}

const FaultKindInfo& info_of(FaultKind kind) {
  return kKinds[static_cast<size_t>(kind)];
}

bool has_time(FaultKind kind) {
  return info_of(kind).input != FaultInput::kMap || kind == FaultKind::kMapCut;
}

Fault make_fault(FaultKind kind, double from_s, double until_s) {
  Fault fault{.kind = kind, .from_s = from_s, .until_s = until_s};
  for (const AmountInfo& amount : info_of(kind).amounts) {
    fault.amounts.*amount.member = amount.fallback.value_or(0.0);
  }
  return fault;
}

}  // namespace bevloc::sim
