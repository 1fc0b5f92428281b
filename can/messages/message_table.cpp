#include "can/messages/message_table.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace bevloc::can {
namespace {

/// The bits of a frame that belong to a signal.
class BitMap {
 public:
  /// Marks the bits of a signal. Returns false when one of them is marked already or is beyond
  /// `length` bytes.
  constexpr bool take(const Signal& signal, size_t length) {
    for (int i = 0; i < signal.length_bits; ++i) {
      const auto bit = static_cast<size_t>(signal.start_bit + i);
      if (bit >= 8 * length || taken_[bit]) return false;
      taken_[bit] = true;
    }
    return true;
  }

 private:
  std::array<bool, 8 * kMaxFdLength> taken_{};
};

/// Whether min and max are whole numbers of steps and fit into the bits, and SNA is out of range.
constexpr bool has_valid_range(const Signal& signal) {
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

constexpr bool is_valid(const Message& message) {
  BitMap bits;
  const auto add = [&](const Signal* signal) {
    return bits.take(*signal, message.length) && has_valid_range(*signal);
  };
  return is_valid_length(message.format, message.length) && message.cycle_ms > 0 &&
         (message.format == FrameFormat::kFd || message.data_id <= UINT8_MAX) &&
         std::ranges::all_of(e2e_header(message.format), add) &&
         std::ranges::all_of(message.signals, add);
}

/// Whether a receiver can tell two messages apart, whatever base ids are configured.
constexpr bool are_distinct(const Message& a, const Message& b) {
  return a.data_id != b.data_id && a.name != b.name &&
         (a.sender != b.sender || a.id_offset != b.id_offset);
}

constexpr bool table_is_valid() {
  for (size_t i = 0; i < std::size(kMessages); ++i) {
    if (!is_valid(*kMessages[i])) return false;
    for (size_t j = 0; j < i; ++j) {
      if (!are_distinct(*kMessages[i], *kMessages[j])) return false;
    }
  }
  return true;
}
static_assert(table_is_valid());

}  // namespace
}  // namespace bevloc::can
