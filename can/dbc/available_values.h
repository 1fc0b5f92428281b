// The values of a signal that are available.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace bevloc::can {

/// The values that are finite, within the range of the DBC file and not named SNA.
struct AvailableValues {
  double min = -std::numeric_limits<double>::infinity();  ///< physical
  double max = std::numeric_limits<double>::infinity();
  std::vector<int64_t> not_available{};  ///< raw values that VAL_ names SNA

  bool has(int64_t raw, double physical) const {
    return std::isfinite(physical) && physical >= min && physical <= max &&
           std::ranges::find(not_available, raw) == not_available.end();
  }
};

}  // namespace bevloc::can
