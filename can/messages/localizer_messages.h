// The message table, part 1: the classic messages that the localizer sends.
#pragma once

#include <array>
#include <cstddef>

#include "can/messages/message.h"
#include "can/messages/shared_signals.h"

namespace bevloc::can {

constexpr int kSolutionCycleMs = 10;
constexpr int kStatusCycleMs = 100;

namespace loc_status {

inline constexpr ValueName kStateNames[] = {{0, "INIT"},     {1, "ACQUIRING"}, {2, "TRACKING"},
                                            {3, "DEGRADED"}, {4, "LOST"},      {5, "FAULT"}};
inline constexpr ValueName kTimeSourceNames[] = {
    {0, "FREE_RUNNING"}, {1, "PTP"}, {2, "GNSS"}, {3, "NTP"}};
inline constexpr ValueName kOkNames[] = {{0, "MISSING"}, {1, "OK"}};
inline constexpr ValueName kReasonNames[] = {{0, "NO"}, {1, "YES"}};

constexpr Signal ok_flag(std::string_view name, int bit, std::string_view comment) {
  return {.name = name,
          .start_bit = bit,
          .length_bits = 1,
          .max = 1,
          .value_names = kOkNames,
          .comment = comment};
}

constexpr Signal reason_flag(std::string_view name, int bit, std::string_view comment) {
  return {.name = name,
          .start_bit = 32 + bit,
          .length_bits = 1,
          .max = 1,
          .value_names = kReasonNames,
          .comment = comment};
}

inline constexpr Signal kState{
    .name = "State",
    .start_bit = 16,
    .length_bits = 4,
    .max = 5,
    .value_names = kStateNames,
    .comment =
        "The pose is valid in TRACKING, also valid in DEGRADED, where an input is missing or in "
        "doubt (Why_*), and not available in every other state. FAULT requires service."};
inline constexpr Signal kTimeSource{.name = "TimeSource",
                                    .start_bit = 20,
                                    .length_bits = 3,
                                    .max = 3,
                                    .value_names = kTimeSourceNames,
                                    .comment = "What disciplines the clock behind CaptureTime."};
inline constexpr Signal kMapOk =
    ok_flag("MapOk", 23,
            "A map is loaded and covers the position of the vehicle. OK also while that is "
            "unknown, for example before the first pose.");
inline constexpr std::array<Signal, 6> kCameraOk{{
    ok_flag("CameraOk_FrontLeft", 24, "Camera front_left delivers usable frames in time."),
    ok_flag("CameraOk_Front", 25, "Camera front delivers usable frames in time."),
    ok_flag("CameraOk_FrontRight", 26, "Camera front_right delivers usable frames in time."),
    ok_flag("CameraOk_BackLeft", 27, "Camera back_left delivers usable frames in time."),
    ok_flag("CameraOk_Back", 28, "Camera back delivers usable frames in time."),
    ok_flag("CameraOk_BackRight", 29, "Camera back_right delivers usable frames in time."),
}};
inline constexpr Signal kOdometryOk =
    ok_flag("OdometryOk", 30, "Valid wheel speed and yaw rate arrive in time.");
inline constexpr Signal kGnssOk = ok_flag("GnssOk", 31, "Valid GNSS positions arrive in time.");
/// The reasons, in the order of the bits of enum Why.
inline constexpr std::array<Signal, 16> kWhy{{
    reason_flag("Why_CameraMissing", 0, "At least one camera delivers no usable frames in time."),
    reason_flag("Why_CamerasUnsynchronized", 1, "The cameras do not expose at the same time."),
    reason_flag("Why_OdometryMissing", 2, "No valid wheel speed or yaw rate."),
    reason_flag("Why_GnssMissing", 3, "No valid GNSS position."),
    reason_flag("Why_NoInitialPose", 4, "The position of the vehicle in the map is not known yet."),
    reason_flag("Why_OutsideMap", 5, "The map has no elements around the vehicle."),
    reason_flag(
        "Why_MatchUncertain", 6,
        "Match, GNSS and odometry disagree, or a new pose lacks matches or GNSS that confirm it."),
    reason_flag("Why_MatchRejected", 7, "The match contradicts odometry and was not used."),
    reason_flag("Why_PoseUncertain", 8,
                "The standard deviation is beyond its limit, or too large for a new pose; or "
                "without matches, the protection level is beyond the alert limit."),
    reason_flag("Why_PoseStale", 9,
                "No match has confirmed the pose for too long, or it is too old to be sent."),
    reason_flag("Why_PoseInvalid", 10, "The pose is not a number or out of range."),
    reason_flag("Why_Overload", 11, "Frames are skipped because computation is too slow."),
    reason_flag("Why_MapFault", 12,
                "GNSS and map lie apart by a constant offset. The pose is not valid."),
    reason_flag("Why_CalibrationFault", 13,
                "A camera is not where the calibration says, and is not used; or the cameras' time "
                "stamps contradict the yaw rate, and the pose is not valid."),
    reason_flag("Why_NetworkFault", 14, "The network computed another answer than it should."),
    reason_flag("Why_InternalFault", 15, "Any other fault inside the localizer."),
}};
inline constexpr Signal kMapId{
    .name = "MapId",
    .start_bit = 48,
    .length_bits = 16,
    .max = 65535,
    .comment = "Checksum of the loaded map; LocalEast and LocalNorth refer to its origin."};

inline constexpr auto kSignals = [] {
  std::array<const Signal*, 6 + kCameraOk.size() + kWhy.size()> all{};
  size_t next = 0;
  all[next++] = &kState;
  all[next++] = &kTimeSource;
  all[next++] = &kMapOk;
  for (const Signal& signal : kCameraOk) all[next++] = &signal;
  all[next++] = &kOdometryOk;
  all[next++] = &kGnssOk;
  for (const Signal& signal : kWhy) all[next++] = &signal;
  all[next++] = &kMapId;
  return all;
}();
inline constexpr Message kMessage{
    .name = "LOC_Status",
    .id_offset = 0,
    .cycle_ms = kStatusCycleMs,
    .data_id = 0x51,
    .signals = kSignals,
    .comment = "Health of the localizer. Sent on its cycle and in addition on every change."};

}  // namespace loc_status

namespace loc_time {

inline constexpr Signal kCaptureTime{
    .name = "CaptureTime",
    .start_bit = 16,
    .length_bits = 32,
    .unit = "us",
    .max = 4294967295.0,
    .comment =
        "Start of exposure of the newest images used, on the localizer's clock, modulo 2^32 "
        "us. Meaningless while CaptureAge is not available."};
inline constexpr Signal kCaptureAge{
    .name = "CaptureAge",
    .start_bit = 48,
    .length_bits = 16,
    .scale = 0.1,
    .unit = "ms",
    .max = 6553.4,
    .has_sna = true,
    .comment =
        "From CaptureTime to the moment of sending. The pose is predicted to that moment: it "
        "holds at CaptureTime + CaptureAge."};
inline constexpr const Signal* kSignals[] = {&kCaptureTime, &kCaptureAge};
inline constexpr Message kMessage{.name = "LOC_Time",
                                  .id_offset = 1,
                                  .cycle_ms = kSolutionCycleMs,
                                  .data_id = 0x52,
                                  .signals = kSignals,
                                  .comment = "The time of this epoch's pose."};

}  // namespace loc_time

namespace loc_latitude {

inline constexpr Signal kLatitude = geodetic_signal("Latitude", 90.0);
inline constexpr Signal kStdDev = std_dev_signal("StdDevNorth", 48, "m", "1 sigma, rounded up.");
inline constexpr const Signal* kSignals[] = {&kLatitude, &kStdDev};
inline constexpr Message kMessage{.name = "LOC_Latitude",
                                  .id_offset = 2,
                                  .cycle_ms = kSolutionCycleMs,
                                  .data_id = 0x53,
                                  .signals = kSignals,
                                  .comment = "Belongs to the LOC_Longitude of the same EPOCH."};

}  // namespace loc_latitude

namespace loc_longitude {

inline constexpr Signal kLongitude = geodetic_signal("Longitude", 180.0);
inline constexpr Signal kStdDev = std_dev_signal("StdDevEast", 48, "m", "1 sigma, rounded up.");
inline constexpr const Signal* kSignals[] = {&kLongitude, &kStdDev};
inline constexpr Message kMessage{.name = "LOC_Longitude",
                                  .id_offset = 3,
                                  .cycle_ms = kSolutionCycleMs,
                                  .data_id = 0x54,
                                  .signals = kSignals,
                                  .comment = "Belongs to the LOC_Latitude of the same EPOCH."};

}  // namespace loc_longitude

namespace loc_pos_local {

inline constexpr Signal kEast{
    .name = "LocalEast",
    .start_bit = 16,
    .length_bits = 24,
    .is_signed = true,
    .scale = 0.01,
    .unit = "m",
    .min = -83886.07,
    .max = 83886.07,
    .has_sna = true,
    .comment =
        "East of the map's origin, in its local tangent plane, along the east at the origin (see "
        "Heading). Of the middle of the rear axle."};
inline constexpr Signal kNorth{
    .name = "LocalNorth",
    .start_bit = 40,
    .length_bits = 24,
    .is_signed = true,
    .scale = 0.01,
    .unit = "m",
    .min = -83886.07,
    .max = 83886.07,
    .has_sna = true,
    .comment =
        "North of the map's origin, in its local tangent plane, along the north at the origin (see "
        "Heading). Of the middle of the rear axle."};
inline constexpr const Signal* kSignals[] = {&kEast, &kNorth};
inline constexpr Message kMessage{
    .name = "LOC_PosLocal",
    .id_offset = 4,
    .cycle_ms = kSolutionCycleMs,
    .data_id = 0x55,
    .signals = kSignals,
    .comment = "The position in the frame of the map that LOC_Status names by MapId."};

}  // namespace loc_pos_local

namespace loc_attitude {

inline constexpr Signal kHeading = heading_signal(
    "Heading",
    "Of the vehicle's x axis, clockwise from true north at the vehicle. Clockwise from LocalNorth, "
    "the direction is Heading - (Longitude - longitude of the map's origin) * sin(Latitude). "
    "(YawRate counts the other way.)");
inline constexpr const Signal* kSignals[] = {&kHeading};
inline constexpr Message kMessage{.name = "LOC_Attitude",
                                  .id_offset = 5,
                                  .length = 4,
                                  .cycle_ms = kSolutionCycleMs,
                                  .data_id = 0x56,
                                  .signals = kSignals,
                                  .comment = "Pitch and roll are not measured."};

}  // namespace loc_attitude

namespace loc_velocity {

inline constexpr Signal kForward{.name = "VelocityX",
                                 .start_bit = 16,
                                 .length_bits = 16,
                                 .is_signed = true,
                                 .scale = 0.01,
                                 .unit = "m/s",
                                 .min = -327.67,
                                 .max = 327.67,
                                 .has_sna = true,
                                 .comment = "Forward speed of the rear axle (ISO 8855)."};
inline constexpr Signal kYawRate{
    .name = "YawRate",
    .start_bit = 32,
    .length_bits = 16,
    .is_signed = true,
    .scale = 0.01,
    .unit = "deg/s",
    .min = -327.67,
    .max = 327.67,
    .has_sna = true,
    .comment = "Positive counter-clockwise seen from above (ISO 8855)."};
inline constexpr const Signal* kSignals[] = {&kForward, &kYawRate};
inline constexpr Message kMessage{.name = "LOC_Velocity",
                                  .id_offset = 6,
                                  .length = 6,
                                  .cycle_ms = kSolutionCycleMs,
                                  .data_id = 0x57,
                                  .signals = kSignals,
                                  .comment = "Motion in the vehicle's frame (x forward, y left)."};

}  // namespace loc_velocity

namespace loc_std_dev {

inline constexpr Signal kLongitudinal =
    std_dev_signal("StdDevLongitudinal", 16, "m", "Along the vehicle, 1 sigma, rounded up.");
inline constexpr Signal kLateral =
    std_dev_signal("StdDevLateral", 32, "m", "Across the vehicle, 1 sigma, rounded up.");
inline constexpr Signal kHeading =
    std_dev_signal("StdDevHeading", 48, "deg", "1 sigma, rounded up.");
inline constexpr const Signal* kSignals[] = {&kLongitudinal, &kLateral, &kHeading};
inline constexpr Message kMessage{.name = "LOC_StdDev",
                                  .id_offset = 7,
                                  .cycle_ms = kSolutionCycleMs,
                                  .data_id = 0x58,
                                  .signals = kSignals,
                                  .comment = "Uncertainty of the pose along the vehicle's axes."};

}  // namespace loc_std_dev

namespace loc_correction {

inline constexpr Signal kLongitudinal{.name = "DeltaLongitudinal",
                                      .start_bit = 16,
                                      .length_bits = 16,
                                      .is_signed = true,
                                      .scale = 0.001,
                                      .unit = "m",
                                      .min = -32.767,
                                      .max = 32.767,
                                      .has_sna = true,
                                      .comment = "Forward, in the frame of the predicted pose."};
inline constexpr Signal kLateral{.name = "DeltaLateral",
                                 .start_bit = 32,
                                 .length_bits = 16,
                                 .is_signed = true,
                                 .scale = 0.001,
                                 .unit = "m",
                                 .min = -32.767,
                                 .max = 32.767,
                                 .has_sna = true,
                                 .comment = "To the left, in the frame of the predicted pose."};
inline constexpr Signal kYaw{.name = "DeltaYaw",
                             .start_bit = 48,
                             .length_bits = 16,
                             .is_signed = true,
                             .scale = 0.01,
                             .unit = "deg",
                             .min = -180.0,
                             .max = 180.0,
                             .has_sna = true,
                             .comment = "Positive counter-clockwise."};
inline constexpr const Signal* kSignals[] = {&kLongitudinal, &kLateral, &kYaw};
inline constexpr Message kMessage{
    .name = "LOC_Correction",
    .id_offset = 8,
    .cycle_ms = kSolutionCycleMs,
    .data_id = 0x59,
    .signals = kSignals,
    .comment =
        "Raw result of matching the newest images with the map, before the tracker judged it. Sent "
        "also without a valid pose. For diagnosis only. Never add it to the pose: the pose "
        "contains it already, or the tracker did not use it (see Why_MatchRejected)."};

}  // namespace loc_correction

}  // namespace bevloc::can
