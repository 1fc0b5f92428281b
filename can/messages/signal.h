// The description of a signal of a CAN message, and its encoding and decoding.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "can/bus/frame.h"

namespace bevloc::can {

struct ValueName {
  int64_t raw = 0;
  std::string_view name;
};

/// A signal in Intel byte order: physical = raw * scale + offset. `min` and `max` bound the valid
/// physical values. With `has_sna`, one raw value means "signal not available" (SNA): all bits set
/// if the signal is unsigned, the most negative number if it is signed.
struct Signal {
  std::string_view name{};
  int start_bit = 0;
  int length_bits = 0;
  bool is_signed = false;
  double scale = 1.0;
  double offset = 0.0;
  std::string_view unit{};
  double min = 0.0;
  double max = 0.0;
  bool has_sna = false;
  std::span<const ValueName> value_names{};
  std::string_view comment{};

  constexpr int64_t sna_raw() const { return is_signed ? lowest_raw() : highest_raw(); }
  constexpr int64_t lowest_raw() const {
    return is_signed ? -(int64_t{1} << (length_bits - 1)) : 0;
  }
  constexpr int64_t highest_raw() const {
    return (int64_t{1} << (is_signed ? length_bits - 1 : length_bits)) - 1;
  }
  /// The nearest raw value, not limited to the signal's range.
  constexpr int64_t nearest_raw(double physical) const {
    const double steps = (physical - offset) / scale;
    return static_cast<int64_t>(steps < 0.0 ? steps - 0.5 : steps + 0.5);
  }
  constexpr double physical(int64_t raw) const { return static_cast<double>(raw) * scale + offset; }
  constexpr int64_t min_raw() const { return nearest_raw(min); }
  constexpr int64_t max_raw() const { return nearest_raw(max); }
};

/// Returns the nearest raw value of `physical`. A value out of range becomes min or max, and a
/// value that is not finite becomes SNA. The signal must have an SNA value.
int64_t raw_from_physical(const Signal& signal, double physical);

/// Returns nothing for SNA and for every other value outside [min, max].
std::optional<double> physical_from_raw(const Signal& signal, int64_t raw);

/// `raw` must fit into the bits of the signal. The signal must lie within the frame's length and
/// touch at most 8 bytes.
void insert_raw(Frame& frame, const Signal& signal, int64_t raw);
int64_t extract_raw(const Frame& frame, const Signal& signal);

inline void encode(Frame& frame, const Signal& signal, double physical) {
  insert_raw(frame, signal, raw_from_physical(signal, physical));
}
inline std::optional<double> decode(const Frame& frame, const Signal& signal) {
  return physical_from_raw(signal, extract_raw(frame, signal));
}

}  // namespace bevloc::can
