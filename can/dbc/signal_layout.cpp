#include "can/dbc/signal_layout.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

namespace bevloc::can {
namespace {

constexpr int kByteBits = 8;

/// Returns the number of the next lower bit of a Motorola signal. Bit 7 of the next byte follows on
/// bit 0 of a byte.
int below(int bit) {
  return bit % kByteBits == 0 ? bit + 2 * kByteBits - 1 : bit - 1;
}

/// Calls visit(bit of the raw value, byte of the frame, bit of that byte) for each bit.
template <typename Visit>
void for_each_bit(const SignalLayout& layout, Visit&& visit) {
  int place = layout.start_bit;
  for (int i = 0; i < layout.length_bits; ++i) {
    const bool intel = layout.order == ByteOrder::kIntel;
    const int value_bit = intel ? i : layout.length_bits - 1 - i;
    visit(value_bit, static_cast<size_t>(place / kByteBits), place % kByteBits);
    place = intel ? place + 1 : below(place);
  }
}

double lowest_raw(const SignalLayout& layout) {
  return layout.type == RawType::kSigned ? -std::ldexp(1.0, layout.length_bits - 1) : 0.0;
}
double highest_raw(const SignalLayout& layout) {
  const int bits = layout.type == RawType::kSigned ? layout.length_bits - 1 : layout.length_bits;
  return std::ldexp(1.0, bits) - 1.0;
}

/// The bits of the nearest whole number within the range.
uint64_t integer_bits(const SignalLayout& layout, double raw) {
  constexpr double kTwoTo63 = 9223372036854775808.0;
  const double nearest = std::round(std::clamp(raw, lowest_raw(layout), highest_raw(layout)));
  if (layout.type == RawType::kUnsigned) {
    return nearest >= 2.0 * kTwoTo63 ? UINT64_MAX : static_cast<uint64_t>(nearest);
  }
  return static_cast<uint64_t>(nearest >= kTwoTo63 ? INT64_MAX : static_cast<int64_t>(nearest));
}

}  // namespace

bool is_integer(const SignalLayout& layout) {
  return layout.type == RawType::kUnsigned || layout.type == RawType::kSigned;
}

size_t bytes_needed(const SignalLayout& layout) {
  size_t last = 0;
  for_each_bit(layout, [&](int, size_t byte, int) { last = std::max(last, byte); });
  return last + 1;
}

uint64_t raw_bits_from(const SignalLayout& layout, std::span<const uint8_t> bytes) {
  uint64_t raw = 0;
  for_each_bit(layout, [&](int value_bit, size_t byte, int bit) {
    assert(byte < bytes.size());
    raw |= uint64_t{bytes[byte] >> bit & 1U} << value_bit;
  });
  return raw;
}

int64_t raw_from(const SignalLayout& layout, std::span<const uint8_t> bytes) {
  const uint64_t bits = raw_bits_from(layout, bytes);
  const int unused = 64 - layout.length_bits;
  if (layout.type != RawType::kSigned) return static_cast<int64_t>(bits);
  return static_cast<int64_t>(bits << unused) >> unused;
}

double physical_from(const SignalLayout& layout, std::span<const uint8_t> bytes) {
  const uint64_t bits = raw_bits_from(layout, bytes);
  double raw = 0.0;
  switch (layout.type) {
    case RawType::kUnsigned:
      raw = static_cast<double>(bits);
      break;
    case RawType::kSigned:
      raw = static_cast<double>(raw_from(layout, bytes));
      break;
    case RawType::kFloat:
      raw = std::bit_cast<float>(static_cast<uint32_t>(bits));
      break;
    case RawType::kDouble:
      raw = std::bit_cast<double>(bits);
      break;
  }
  return raw * layout.scale + layout.offset;
}

void insert_bits(const SignalLayout& layout, uint64_t raw, std::span<uint8_t> bytes) {
  for_each_bit(layout, [&](int value_bit, size_t byte, int bit) {
    assert(byte < bytes.size());
    const auto mask = static_cast<uint8_t>(1U << bit);
    const bool is_set = (raw >> value_bit & 1U) != 0;
    bytes[byte] = static_cast<uint8_t>(is_set ? bytes[byte] | mask : bytes[byte] & ~mask);
  });
}

void insert_physical(const SignalLayout& layout, double physical, std::span<uint8_t> bytes) {
  const double raw = (physical - layout.offset) / layout.scale;
  uint64_t bits = 0;
  if (layout.type == RawType::kFloat) {
    bits = std::bit_cast<uint32_t>(static_cast<float>(raw));
  } else if (layout.type == RawType::kDouble) {
    bits = std::bit_cast<uint64_t>(raw);
  } else {
    bits = integer_bits(layout, raw);
  }
  insert_bits(layout, bits, bytes);
}

double lowest_physical(const SignalLayout& layout) {
  if (!is_integer(layout)) return -std::numeric_limits<double>::infinity();
  const double a = lowest_raw(layout) * layout.scale;
  return std::min(a, highest_raw(layout) * layout.scale) + layout.offset;
}

double highest_physical(const SignalLayout& layout) {
  if (!is_integer(layout)) return std::numeric_limits<double>::infinity();
  const double a = lowest_raw(layout) * layout.scale;
  return std::max(a, highest_raw(layout) * layout.scale) + layout.offset;
}

}  // namespace bevloc::can
