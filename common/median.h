// The median of unordered values.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace bevloc {

/// Returns the middle one of the sorted values. If their number is even, returns the larger one of
/// the two in the middle. Reorders `values`, which must not be empty.
template <typename T>
T median(std::vector<T>& values) {
  assert(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace bevloc
