// The message table, part 6: the messages that authenticate others, sent only with `can.secoc`.
#pragma once

#include "can/messages/localizer_messages.h"
#include "can/messages/message.h"
#include "can/messages/vehicle_messages.h"

namespace bevloc::can {

constexpr int kFreshnessCycleMs = 100;

namespace secoc {

inline constexpr Signal kFreshnessLow{
    .name = "FreshnessLow",
    .start_bit = 16,
    .length_bits = 16,
    .max = 65535,
    .comment = "Bits 0 to 15 of this epoch's freshness value, which rises with every epoch."};
inline constexpr Signal kMac{
    .name = "Mac",
    .start_bit = 32,
    .length_bits = 32,
    .max = 4294967295.0,
    .comment =
        "The first 4 bytes of the AES-128 CMAC over E2EDataId (1 byte), the freshness value (8 "
        "bytes), and for each frame of the epoch in the order of the identifiers: identifier (2 "
        "bytes), length (1 byte) and all bytes of the frame. Numbers high byte first; the first "
        "byte of the CMAC is the lowest of this signal."};
inline constexpr const Signal* kAuthenticationSignals[] = {&kFreshnessLow, &kMac};

inline constexpr Signal kFreshnessHigh{
    .name = "FreshnessHigh",
    .start_bit = 16,
    .length_bits = 48,
    .max = 281474976710655.0,
    .comment = "Bits 16 to 63 of the sender's latest freshness value."};
inline constexpr const Signal* kFreshnessSignals[] = {&kFreshnessHigh};

}  // namespace secoc

namespace loc_authentication {
inline constexpr Message kMessage{
    .name = "LOC_Authentication",
    .id_offset = 12,
    .cycle_ms = kSolutionCycleMs,
    .data_id = 0x5C,
    .signals = secoc::kAuthenticationSignals,
    .comment =
        "Only with can.secoc. Authenticates the other LOC_ frames of the same EPOCH except "
        "LOC_Clock and LOC_Freshness, or the LOC_Solution before it."};
}  // namespace loc_authentication

namespace loc_freshness {
inline constexpr Message kMessage{.name = "LOC_Freshness",
                                  .id_offset = 13,
                                  .cycle_ms = kFreshnessCycleMs,
                                  .data_id = 0x5D,
                                  .signals = secoc::kFreshnessSignals,
                                  .comment = "Only with can.secoc. Not authenticated itself."};
}  // namespace loc_freshness

namespace veh_odometry_authentication {
inline constexpr Message kMessage{
    .name = "VEH_OdometryAuthentication",
    .sender = Sender::kVehicle,
    .id_offset = 5,
    .cycle_ms = kOdometryCycleMs,
    .data_id = 0x46,
    .signals = secoc::kAuthenticationSignals,
    .comment =
        "Only with can.secoc. Authenticates VEH_WheelSpeed and VEH_YawRate of the same EPOCH, "
        "and is sent after them."};
}  // namespace veh_odometry_authentication

namespace veh_gnss_authentication {
inline constexpr Message kMessage{
    .name = "VEH_GnssAuthentication",
    .sender = Sender::kVehicle,
    .id_offset = 6,
    .cycle_ms = kGnssCycleMs,
    .data_id = 0x47,
    .signals = secoc::kAuthenticationSignals,
    .comment =
        "Only with can.secoc. Authenticates the three VEH_Gnss messages of the same EPOCH, and "
        "is sent after them."};
}  // namespace veh_gnss_authentication

namespace veh_freshness {
inline constexpr Message kMessage{.name = "VEH_Freshness",
                                  .sender = Sender::kVehicle,
                                  .id_offset = 7,
                                  .cycle_ms = kFreshnessCycleMs,
                                  .data_id = 0x48,
                                  .signals = secoc::kFreshnessSignals,
                                  .comment = "Only with can.secoc. Not authenticated itself."};
}  // namespace veh_freshness

/// Whether the message is sent only with `can.secoc`.
constexpr bool is_secoc_message(const Message& message) {
  return message.signals.data() == secoc::kAuthenticationSignals ||
         message.signals.data() == secoc::kFreshnessSignals;
}

}  // namespace bevloc::can
