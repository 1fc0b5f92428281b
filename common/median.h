// The median of unordered values.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace bevloc {

/// The value in the middle, of two the larger one. Reorders `values`, of which there must be one.
template <typename T>
T median(std::vector<T>& values) {
  assert(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace bevloc
