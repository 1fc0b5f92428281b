#include "can/message_table.h"

#include <algorithm>
#include <iterator>

namespace bevloc::can {
namespace {

constexpr uint64_t bits_of(const Signal& signal) {
  return ((uint64_t{1} << signal.length_bits) - 1) << signal.start_bit;
}

/// The valid range is a whole number of steps, fits into the bits and leaves SNA out.
constexpr bool has_sound_range(const Signal& signal) {
  const auto is_step = [&](double physical) {
    const double error = physical - signal.physical(signal.nearest_raw(physical));
    return error < 1e-3 * signal.scale && error > -1e-3 * signal.scale;
  };
  const bool clear_of_sna =
      !signal.has_sna || signal.sna_raw() < signal.min_raw() || signal.sna_raw() > signal.max_raw();
  return signal.min < signal.max && is_step(signal.min) && is_step(signal.max) &&
         signal.min_raw() >= signal.lowest_raw() && signal.max_raw() <= signal.highest_raw() &&
         clear_of_sna;
}

constexpr bool is_sound(const Message& message) {
  uint64_t taken = 0;
  const auto add = [&](const Signal& signal) {
    const bool free = (taken & bits_of(signal)) == 0;
    taken |= bits_of(signal);
    return free && signal.start_bit + signal.length_bits <= 8 * message.length &&
           has_sound_range(signal);
  };
  return message.length <= kMaxFrameLength && message.cycle_ms > 0 &&
         std::ranges::all_of(kE2eHeader, [&](const Signal* signal) { return add(*signal); }) &&
         std::ranges::all_of(message.signals, [&](const Signal* signal) { return add(*signal); });
}

/// A message must not pass for another one, whatever base ids are configured.
constexpr bool are_distinct(const Message& a, const Message& b) {
  return a.data_id != b.data_id && a.name != b.name &&
         (a.sender != b.sender || a.id_offset != b.id_offset);
}

constexpr bool table_is_sound() {
  for (size_t i = 0; i < std::size(kMessages); ++i) {
    if (!is_sound(*kMessages[i])) return false;
    for (size_t j = 0; j < i; ++j) {
      if (!are_distinct(*kMessages[i], *kMessages[j])) return false;
    }
  }
  return true;
}
static_assert(table_is_sound());

}  // namespace
}  // namespace bevloc::can
