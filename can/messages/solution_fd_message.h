// The message table, part 4: LOC_Solution, which carries a whole solution in one CAN FD frame.
#pragma once

#include <array>
#include <cstddef>

#include "can/messages/identity_message.h"
#include "can/messages/integrity_message.h"
#include "can/messages/localizer_messages.h"

namespace bevloc::can::loc_solution {

/// The classic messages whose content LOC_Solution carries, in this order. Each part is the content
/// of the classic frame without its E2E header, so both variants share one table of signals. A new
/// part goes to the end, because the signals must not move.
inline constexpr std::array<const Message*, 11> kParts = {
    &loc_status::kMessage,    &loc_time::kMessage,      &loc_latitude::kMessage,
    &loc_longitude::kMessage, &loc_pos_local::kMessage, &loc_attitude::kMessage,
    &loc_velocity::kMessage,  &loc_std_dev::kMessage,   &loc_correction::kMessage,
    &loc_integrity::kMessage, &loc_identity::kMessage};

/// The byte of the FD frame at which the content of a part begins.
constexpr size_t first_byte_of(size_t part) {
  size_t byte = header_length(FrameFormat::kFd);
  for (size_t i = 0; i < part; ++i) byte += content_length(*kParts[i]);
  return byte;
}

constexpr size_t count_signals() {
  size_t count = 0;
  for (const Message* part : kParts) count += part->signals.size();
  return count;
}

inline constexpr auto kMovedSignals = [] {
  std::array<Signal, count_signals()> moved{};
  size_t next = 0;
  for (size_t part = 0; part < kParts.size(); ++part) {
    const int bytes = static_cast<int>(first_byte_of(part)) -
                      static_cast<int>(header_length(FrameFormat::kClassic));
    for (const Signal* signal : kParts[part]->signals) {
      moved[next] = *signal;
      moved[next++].start_bit += 8 * bytes;
    }
  }
  return moved;
}();

inline constexpr auto kSignals = [] {
  std::array<const Signal*, kMovedSignals.size()> all{};
  for (size_t i = 0; i < all.size(); ++i) all[i] = &kMovedSignals[i];
  return all;
}();

inline constexpr Message kMessage{
    .name = "LOC_Solution",
    .id_offset = 9,
    .length = kMaxFdLength,
    .format = FrameFormat::kFd,
    .cycle_ms = kSolutionCycleMs,
    .data_id = 0x505A,
    .signals = kSignals,
    .comment = "CAN FD. Status and solution in one frame, instead of the other LOC_ messages."};

}  // namespace bevloc::can::loc_solution
