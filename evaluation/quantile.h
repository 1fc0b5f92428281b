// Quantiles of a series of values.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace bevloc::evaluation {

/// The smallest value that a share `quantile` of the values does not exceed (nearest rank). The
/// median of an even number is the lower of the middle two. 0 if there are no values.
inline double quantile_of(std::vector<double> values, double quantile) {
  if (values.empty()) return 0.0;
  const auto count = static_cast<double>(values.size());
  const auto rank = static_cast<size_t>(std::max(1.0, std::ceil(quantile * count)));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace bevloc::evaluation
