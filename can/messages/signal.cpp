#include "can/messages/signal.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace bevloc::can {
namespace {

uint64_t mask_of(const Signal& signal) {
  assert(signal.length_bits > 0 && signal.length_bits < 64);
  return (uint64_t{1} << signal.length_bits) - 1;
}

/// The bytes that hold a signal. The first `shift` bits do not belong to it.
struct Place {
  size_t first_byte;
  size_t end_byte;
  int shift;
};

Place place_of([[maybe_unused]] const Frame& frame, const Signal& signal) {
  const int end_bit = signal.start_bit + signal.length_bits;
  const Place place{static_cast<size_t>(signal.start_bit / 8),
                    static_cast<size_t>((end_bit + 7) / 8), signal.start_bit % 8};
  assert(place.end_byte <= frame.length && place.shift + signal.length_bits <= 64);
  return place;
}

uint64_t load(const Frame& frame, const Place& place) {
  uint64_t word = 0;
  for (size_t i = place.first_byte; i < place.end_byte; ++i) {
    word |= uint64_t{frame.data[i]} << (8 * (i - place.first_byte));
  }
  return word;
}

void store(Frame& frame, const Place& place, uint64_t word) {
  for (size_t i = place.first_byte; i < place.end_byte; ++i) {
    frame.data[i] = static_cast<uint8_t>(word >> (8 * (i - place.first_byte)));
  }
}

}  // namespace

int64_t raw_from_physical(const Signal& signal, double physical) {
  assert(signal.has_sna);
  if (!std::isfinite(physical)) return signal.sna_raw();
  return signal.nearest_raw(std::clamp(physical, signal.min, signal.max));
}

std::optional<double> physical_from_raw(const Signal& signal, int64_t raw) {
  if (signal.has_sna && raw == signal.sna_raw()) return std::nullopt;
  if (raw < signal.min_raw() || raw > signal.max_raw()) return std::nullopt;
  return signal.physical(raw);
}

void insert_raw(Frame& frame, const Signal& signal, int64_t raw) {
  assert(raw >= signal.lowest_raw() && raw <= signal.highest_raw());
  const Place place = place_of(frame, signal);
  const uint64_t mask = mask_of(signal) << place.shift;
  const uint64_t bits = (static_cast<uint64_t>(raw) << place.shift) & mask;
  store(frame, place, (load(frame, place) & ~mask) | bits);
}

int64_t extract_raw(const Frame& frame, const Signal& signal) {
  const Place place = place_of(frame, signal);
  const uint64_t bits = (load(frame, place) >> place.shift) & mask_of(signal);
  const uint64_t sign_bit = uint64_t{1} << (signal.length_bits - 1);
  if (!signal.is_signed || (bits & sign_bit) == 0) return static_cast<int64_t>(bits);
  return static_cast<int64_t>(bits | ~mask_of(signal));
}

}  // namespace bevloc::can
