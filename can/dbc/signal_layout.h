// Where the bits of a signal lie in a frame, in either byte order, and what they mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace bevloc::can {

enum class ByteOrder : uint8_t {
  kIntel,     ///< the start bit is the lowest bit of the signal
  kMotorola,  ///< the start bit is the highest bit of the signal
};
enum class RawType : uint8_t { kUnsigned, kSigned, kFloat, kDouble };

/// Bits are numbered as in DBC files: bit 0 is the lowest bit of byte 0, bit 8 that of byte 1.
/// physical = raw * scale + offset.
struct SignalLayout {
  int start_bit = 0;
  int length_bits = 0;  ///< 1 to 64
  ByteOrder order = ByteOrder::kIntel;
  RawType type = RawType::kUnsigned;
  double scale = 1.0;
  double offset = 0.0;

  bool operator==(const SignalLayout&) const = default;
};

/// Whether the raw value is a whole number, not a float.
bool is_integer(const SignalLayout& layout);
/// Number of bytes that a frame must have for this signal.
size_t bytes_needed(const SignalLayout& layout);

/// The functions below need a frame of at least bytes_needed().

uint64_t raw_bits_from(const SignalLayout& layout, std::span<const uint8_t> bytes);
/// The raw value as a whole number, with its sign. An unsigned value of 64 bits may become
/// negative. For kFloat and kDouble this is the number that the bits form.
int64_t raw_from(const SignalLayout& layout, std::span<const uint8_t> bytes);
/// The result is not finite if a float in the frame is not.
double physical_from(const SignalLayout& layout, std::span<const uint8_t> bytes);

void insert_bits(const SignalLayout& layout, uint64_t raw, std::span<uint8_t> bytes);
/// Writes the nearest value, limited to what the bits can hold. `physical` must be finite.
void insert_physical(const SignalLayout& layout, double physical, std::span<uint8_t> bytes);

/// The lowest and highest physical values that the bits can hold. They are infinite for floats.
double lowest_physical(const SignalLayout& layout);
double highest_physical(const SignalLayout& layout);

}  // namespace bevloc::can
