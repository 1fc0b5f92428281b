// The message table, part 3: LOC_Identity, which says with which files the localizer runs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "can/messages/localizer_messages.h"

namespace bevloc::can {

/// The CRC-32 of each item that decides what the localizer sends.
struct Identity {
  uint32_t program = 0;        ///< CRC of the text that `bevlocd --version` prints
  uint32_t configuration = 0;  ///< CRC of the file
  uint32_t model = 0;          ///< CRC of the file
  uint32_t rig = 0;            ///< CRC of the file
  uint32_t map = 0;            ///< CRC of the content, whatever the file format (map_checksum())
};

namespace loc_identity {

constexpr int kItemCycleMs = 200;

inline constexpr ValueName kItemNames[] = {
    {0, "PROGRAM"}, {1, "CONFIGURATION"}, {2, "MODEL"}, {3, "RIG"}, {4, "MAP"}};
inline constexpr int kItems = 5;

inline constexpr Signal kItem{.name = "IdentityItem",
                              .start_bit = 16,
                              .length_bits = 4,
                              .max = kItems - 1,
                              .value_names = kItemNames,
                              .comment = "What IdentityChecksum belongs to."};
inline constexpr Signal kChecksum{
    .name = "IdentityChecksum",
    .start_bit = 24,
    .length_bits = 32,
    .max = 4294967295.0,
    .comment =
        "CRC-32 (IEEE 802.3) of the file; for the map of its content, whatever the file format; "
        "for the program of the version's text. bevlocd logs the same values at its start."};
inline constexpr const Signal* kSignals[] = {&kItem, &kChecksum};
inline constexpr Message kMessage{
    .name = "LOC_Identity",
    .id_offset = 11,
    .cycle_ms = kItemCycleMs,
    .data_id = 0x5B,
    .signals = kSignals,
    .comment = "The items in turn, so that all five are known after one second."};

}  // namespace loc_identity
}  // namespace bevloc::can
