// The standard normal distribution: mean 0, standard deviation 1.
#pragma once

#include <cmath>
#include <numbers>

namespace bevloc {

/// Probability that the variable exceeds `value`.
inline double upper_tail(double value) {
  return 0.5 * std::erfc(value / std::numbers::sqrt2);
}

}  // namespace bevloc
