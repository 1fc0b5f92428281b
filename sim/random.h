// Seeded randomness that gives the same numbers with every standard library.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

namespace bevloc::sim {

/// SplitMix64: a good 64-bit mixer; also turns (seed, purpose) into independent seeds.
constexpr uint64_t mix_seed(uint64_t value) {
  value += 0x9E3779B97F4A7C15ULL;
  value = (value ^ (value >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  value = (value ^ (value >> 27U)) * 0x94D049BB133111EBULL;
  return value ^ (value >> 31U);
}

/// An independent seed for one purpose ("gnss", "traffic") of a seeded whole.
constexpr uint64_t seed_for(uint64_t seed, std::string_view purpose) {
  for (const char c : purpose) seed = mix_seed(seed ^ static_cast<uint64_t>(c));
  return seed;
}

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
