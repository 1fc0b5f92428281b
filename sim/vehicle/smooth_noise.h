// Smooth random functions, used for noise along a drive and over a map.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "sim/random.h"

namespace bevloc::sim {

/// A sum of sines with random wavelengths and phases: zero mean and a given standard deviation.
/// Immutable, and so thread-safe.
class SmoothNoise {
 public:
  /// The wavelengths lie between `shortest` and `longest`, in the unit of the argument of at().
  SmoothNoise(uint64_t seed, double sigma, double shortest, double longest) {
    Random random(seed);
    const double amplitude = sigma * std::sqrt(2.0 / static_cast<double>(kWaves));
    for (size_t i = 0; i < kWaves; ++i) {
      const double fraction = (static_cast<double>(i) + random.uniform()) / kWaves;
      const double wavelength = shortest * std::pow(longest / shortest, fraction);
      waves_[i] = {amplitude, 2.0 * std::numbers::pi / wavelength,
                   random.uniform(0.0, 2.0 * std::numbers::pi)};
    }
  }

  double at(double x) const {
    double sum = 0.0;
    for (const Wave& wave : waves_)
      sum += wave.amplitude * std::sin(wave.frequency * x + wave.phase);
    return sum;
  }

 private:
  static constexpr size_t kWaves = 6;
  struct Wave {
    double amplitude;
    double frequency;
    double phase;
  };
  std::array<Wave, kWaves> waves_;
};

}  // namespace bevloc::sim
