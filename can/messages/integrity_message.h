// The message table, part 2: LOC_Integrity, which says how far the pose can be wrong, and why.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "can/messages/localizer_messages.h"
#include "common/health_state.h"

namespace bevloc::can::loc_integrity {

constexpr Signal protection_signal(std::string_view name, int start_bit, int length_bits,
                                   std::string_view unit, double max, std::string_view comment) {
  return {.name = name,
          .start_bit = start_bit,
          .length_bits = length_bits,
          .scale = 0.01,
          .unit = unit,
          .max = max,
          .has_sna = true,
          .comment = comment};
}

inline constexpr Signal kLateral = protection_signal(
    "ProtectionLateral", 16, 11, "m", 20.46,
    "Bound of the error across the vehicle, rounded up. SNA without a valid pose or a bound.");
inline constexpr Signal kLongitudinal = protection_signal(
    "ProtectionLongitudinal", 27, 12, "m", 40.94,
    "Bound of the error along the vehicle, rounded up. SNA without a valid pose or a bound.");
inline constexpr Signal kYaw = protection_signal(
    "ProtectionYaw", 39, 11, "deg", 20.46,
    "Bound of the error of the heading, rounded up. SNA without a valid pose or a bound.");
inline constexpr Signal kRiskExponent{
    .name = "IntegrityRiskExponent",
    .start_bit = 50,
    .length_bits = 4,
    .max = 14,
    .has_sna = true,
    .comment =
        "n: for each axis, the error of one pose is beyond its protection level with a "
        "probability of at most 10^-n."};

/// The bit of enum Why that belongs to the first reason of this message.
inline constexpr int kFirstWhy = static_cast<int>(loc_status::kWhy.size());

constexpr Signal reason_flag(std::string_view name, int bit, std::string_view comment) {
  return {.name = name,
          .start_bit = 54 + bit - kFirstWhy,
          .length_bits = 1,
          .max = 1,
          .value_names = loc_status::kReasonNames,
          .comment = comment};
}

/// The reasons, in the order of the bits of enum Why.
inline constexpr std::array<Signal, 6> kWhy{{
    reason_flag("Why_GnssContradicts", 16,
                "GNSS contradicts match and odometry and is not used, or it scatters more than it "
                "states, or it is too old."),
    reason_flag("Why_OdometryContradicts", 17,
                "Odometry contradicts match and GNSS. The pose is not predicted with it."),
    reason_flag("Why_MatchContradicts", 18,
                "The match contradicts GNSS and odometry and is not used."),
    reason_flag("Why_ClockGap", 19,
                "The clock jumped, for example after a suspend. The old pose is discarded."),
    reason_flag("Why_OdometryImplausible", 20,
                "Wheel speeds and yaw rate contradict each other, change faster than a vehicle "
                "can, come too seldom, or repeat while driving; or too many of their frames are "
                "damaged."),
    reason_flag("Why_ForeignSender", 21,
                "Another node sends with the localizer's identifiers, or the vehicle's messages "
                "come from two senders or are not authentic."),
}};
static_assert(kFirstWhy + static_cast<int>(kWhy.size()) == kWhyCount);

inline constexpr auto kSignals = [] {
  std::array<const Signal*, 4 + kWhy.size()> all{&kLateral, &kLongitudinal, &kYaw, &kRiskExponent};
  for (size_t i = 0; i < kWhy.size(); ++i) all[4 + i] = &kWhy[i];
  return all;
}();
inline constexpr Message kMessage{
    .name = "LOC_Integrity",
    .id_offset = 10,
    .cycle_ms = kSolutionCycleMs,
    .data_id = 0x5A,
    .signals = kSignals,
    .comment =
        "Protection levels of this epoch's pose along the vehicle's axes, and the reasons that "
        "have no room in LOC_Status. It follows the pose messages of every epoch."};

}  // namespace bevloc::can::loc_integrity
