#include "pipeline/network/model/limits.h"

#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {

int64_t checked_element_count(const Shape& shape, const std::string& what) {
  if (shape.size() > kMostAxes) {
    refuse("{} has {} axes, wanted at most {}", what, shape.size(), kMostAxes);
  }
  int64_t count = 1;
  for (const int64_t length : shape) {
    // Divides instead of multiplying, so that a damaged shape cannot overflow.
    if (length < 1 || length > kMostElements / count) {
      refuse("{} has shape {}, wanted axes of at least 1 and at most {} elements", what,
             to_string(shape), kMostElements);
    }
    count *= length;
  }
  return count;
}

}  // namespace bevloc::nn
