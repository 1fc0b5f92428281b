// Seeded random numbers that are the same with every standard library.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "common/mix.h"

namespace bevloc::sim {

/// SplitMix64: a 64-bit mixing function.
constexpr uint64_t mix_seed(uint64_t value) {
  return mix_bits(value + 0x9E3779B97F4A7C15ULL);
}

/// Derives an independent seed for one purpose, such as "gnss" or "traffic".
constexpr uint64_t seed_for(uint64_t seed, std::string_view purpose) {
  for (const char c : purpose) seed = mix_seed(seed ^ static_cast<uint64_t>(c));
  return seed;
}

/// A random number generator on SplitMix64. One thread.
///
/// If a call needs two random numbers, store each in a variable first. GCC evaluates the arguments
/// of a call in another order on arm64 than on amd64.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(mix_seed(seed)) {}

  uint64_t bits() { return state_ = mix_seed(state_); }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in {low, ..., high}.
  int integer(int low, int high) {
    return low + static_cast<int>(uniform() * (static_cast<double>(high) - low + 1));
  }
  /// Uniform index into a container of `count` elements; count > 0.
  size_t index(size_t count) {
    return static_cast<size_t>(integer(0, static_cast<int>(count) - 1));
  }
  /// True with this probability.
  bool chance(double probability) { return uniform() < probability; }
  /// Standard normal, by Box-Muller.
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  double normal(double mean, double sigma) { return mean + sigma * normal(); }

 private:
  uint64_t state_;
};

}  // namespace bevloc::sim
