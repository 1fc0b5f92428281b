// The message table, part 7: LOC_Clock, which relates the localizer's clock to UTC.
#pragma once

#include "can/messages/message.h"

namespace bevloc::can::loc_clock {

constexpr int kCycleMs = 100;

inline constexpr Signal kUtcOffset{
    .name = "UtcOffset",
    .start_bit = 16,
    .length_bits = 32,
    .unit = "us",
    .max = 4294967295.0,
    .comment =
        "UTC since 1970 minus the localizer's clock, modulo 2^32 us: CaptureTime + UtcOffset is "
        "UTC. Meaningless while UtcError is not available."};
inline constexpr Signal kUtcError{.name = "UtcError",
                                  .start_bit = 48,
                                  .length_bits = 16,
                                  .scale = 0.01,
                                  .unit = "ms",
                                  .max = 655.34,
                                  .has_sna = true,
                                  .comment =
                                      "The kernel's bound of the error of UTC, rounded up. SNA "
                                      "while TimeSource is FREE_RUNNING."};
inline constexpr const Signal* kSignals[] = {&kUtcOffset, &kUtcError};
inline constexpr Message kMessage{
    .name = "LOC_Clock",
    .id_offset = 14,
    .cycle_ms = kCycleMs,
    .data_id = 0x5E,
    .signals = kSignals,
    .comment =
        "Only with the section clock of the configuration, in both variants. Not authenticated."};

}  // namespace bevloc::can::loc_clock
