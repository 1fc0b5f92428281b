// The message table, part 5: the messages that the vehicle sends to the localizer.
#pragma once

#include "can/messages/message.h"
#include "can/messages/shared_signals.h"

namespace bevloc::can {

constexpr int kOdometryCycleMs = 20;
constexpr int kGnssCycleMs = 100;

namespace veh_wheel_speed {

inline constexpr Signal kRearLeft{.name = "WheelSpeedRearLeft",
                                  .start_bit = 16,
                                  .length_bits = 16,
                                  .is_signed = true,
                                  .scale = 0.0025,
                                  .unit = "m/s",
                                  .min = -81.9175,
                                  .max = 81.9175,
                                  .has_sna = true,
                                  .comment = "Circumferential speed, negative backwards."};
inline constexpr Signal kRearRight{.name = "WheelSpeedRearRight",
                                   .start_bit = 32,
                                   .length_bits = 16,
                                   .is_signed = true,
                                   .scale = 0.0025,
                                   .unit = "m/s",
                                   .min = -81.9175,
                                   .max = 81.9175,
                                   .has_sna = true,
                                   .comment = "Circumferential speed, negative backwards."};
inline constexpr const Signal* kSignals[] = {&kRearLeft, &kRearRight};
inline constexpr Message kMessage{.name = "VEH_WheelSpeed",
                                  .sender = Sender::kVehicle,
                                  .id_offset = 0,
                                  .length = 6,
                                  .cycle_ms = kOdometryCycleMs,
                                  .data_id = 0x41,
                                  .signals = kSignals,
                                  .comment = "Belongs to the VEH_YawRate of the same EPOCH."};

}  // namespace veh_wheel_speed

namespace veh_yaw_rate {

inline constexpr Signal kYawRate{
    .name = "YawRate",
    .start_bit = 16,
    .length_bits = 16,
    .is_signed = true,
    .scale = 0.005,
    .unit = "deg/s",
    .min = -163.835,
    .max = 163.835,
    .has_sna = true,
    .comment = "Positive counter-clockwise seen from above (ISO 8855)."};
inline constexpr const Signal* kSignals[] = {&kYawRate};
inline constexpr Message kMessage{.name = "VEH_YawRate",
                                  .sender = Sender::kVehicle,
                                  .id_offset = 1,
                                  .length = 4,
                                  .cycle_ms = kOdometryCycleMs,
                                  .data_id = 0x42,
                                  .signals = kSignals,
                                  .comment = "Belongs to the VEH_WheelSpeed of the same EPOCH."};

}  // namespace veh_yaw_rate

namespace veh_gnss_latitude {

inline constexpr Signal kLatitude = geodetic_signal("GnssLatitude", 90.0);
inline constexpr Signal kStdDev = std_dev_signal("GnssStdDevNorth", 48, "m", "1 sigma.");
inline constexpr const Signal* kSignals[] = {&kLatitude, &kStdDev};
inline constexpr Message kMessage{
    .name = "VEH_GnssLatitude",
    .sender = Sender::kVehicle,
    .id_offset = 2,
    .cycle_ms = kGnssCycleMs,
    .data_id = 0x43,
    .signals = kSignals,
    .comment = "Belongs to VEH_GnssLongitude and VEH_GnssHeading of the same EPOCH."};

}  // namespace veh_gnss_latitude

namespace veh_gnss_longitude {

inline constexpr Signal kLongitude = geodetic_signal("GnssLongitude", 180.0);
inline constexpr Signal kStdDev = std_dev_signal("GnssStdDevEast", 48, "m", "1 sigma.");
inline constexpr const Signal* kSignals[] = {&kLongitude, &kStdDev};
inline constexpr Message kMessage{
    .name = "VEH_GnssLongitude",
    .sender = Sender::kVehicle,
    .id_offset = 3,
    .cycle_ms = kGnssCycleMs,
    .data_id = 0x44,
    .signals = kSignals,
    .comment = "Belongs to VEH_GnssLatitude and VEH_GnssHeading of the same EPOCH."};

}  // namespace veh_gnss_longitude

namespace veh_gnss_heading {

inline constexpr Signal kHeading = heading_signal(
    "GnssHeading",
    "Of the vehicle's x axis, clockwise from true north. SNA when the receiver has no heading, "
    "for example from course over ground at standstill.");
inline constexpr Signal kStdDev = std_dev_signal("GnssStdDevHeading", 32, "deg", "1 sigma.");
inline constexpr const Signal* kSignals[] = {&kHeading, &kStdDev};
inline constexpr Message kMessage{
    .name = "VEH_GnssHeading",
    .sender = Sender::kVehicle,
    .id_offset = 4,
    .length = 6,
    .cycle_ms = kGnssCycleMs,
    .data_id = 0x45,
    .signals = kSignals,
    .comment = "Sent with every position, also when the heading is not available."};

}  // namespace veh_gnss_heading

}  // namespace bevloc::can
