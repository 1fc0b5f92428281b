// The root mean square of values.
#pragma once

#include <cmath>
#include <vector>

namespace bevloc::test {

template <typename Value>
double root_mean_square(const std::vector<Value>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace bevloc::test
