// Interpolation by cubic convolution (Keys 1981, a = -1/2).
#pragma once

#include <array>
#include <cmath>

namespace bevloc {

inline constexpr int kCubicTaps = 4;

/// The samples first ... first + 3 and their weights. The interpolation reproduces parabolas.
struct CubicTaps {
  int first;
  std::array<float, kCubicTaps> weight;
};

/// Taps that read a sequence of samples at `position`, which may be fractional.
inline CubicTaps cubic_taps(double position) {
  const double whole = std::floor(position);
  const double t = position - whole;
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {
      static_cast<int>(whole) - 1,
      {static_cast<float>(0.5 * (-t + 2.0 * t2 - t3)),
       static_cast<float>(0.5 * (2.0 - 5.0 * t2 + 3.0 * t3)),
       static_cast<float>(0.5 * (t + 4.0 * t2 - 3.0 * t3)), static_cast<float>(0.5 * (t3 - t2))}};
}

}  // namespace bevloc
