// Units of speed in map files.
#pragma once

namespace bevloc {

/// A division by it is exact where the factor 1 / 3.6 would be rounded.
inline constexpr double kKmh_per_mps = 3.6;
inline constexpr double kMps_per_mph = 0.44704;

}  // namespace bevloc
