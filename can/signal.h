// One signal of a CAN message: where its bits are and what they mean.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "can/frame.h"

namespace bevloc::can {

struct ValueName {
  int64_t raw = 0;
  std::string_view name;
};

/// A signal in Intel byte order: physical = raw * scale + offset. `min` and `max` bound the valid
/// physical values. With `has_sna`, one raw value says "signal not available": all bits set when
/// unsigned, the most negative number when signed.
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

/// The raw value of `physical`: the nearest step, held at min or max when out of range, and SNA
/// when it is not a finite number. The signal must have an SNA.
int64_t raw_from_physical(const Signal& signal, double physical);

/// None for SNA and for every other value outside [min, max].
std::optional<double> physical_from_raw(const Signal& signal, int64_t raw);

/// `raw` must fit into the signal's bits, and these into the frame's length and into 8 bytes.
void insert_raw(Frame& frame, const Signal& signal, int64_t raw);
int64_t extract_raw(const Frame& frame, const Signal& signal);

inline void encode(Frame& frame, const Signal& signal, double physical) {
  insert_raw(frame, signal, raw_from_physical(signal, physical));
}
inline std::optional<double> decode(const Frame& frame, const Signal& signal) {
  return physical_from_raw(signal, extract_raw(frame, signal));
}

}  // namespace bevloc::can
