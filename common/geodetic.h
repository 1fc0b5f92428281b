// The range of latitudes and longitudes.
#pragma once

namespace bevloc {

inline constexpr double kMostLatitude_deg = 90.0;
inline constexpr double kMostLongitude_deg = 180.0;

/// Whether there is such a place. Returns false for a number that is NaN.
constexpr bool is_on_earth(double latitude_deg, double longitude_deg) {
  return latitude_deg >= -kMostLatitude_deg && latitude_deg <= kMostLatitude_deg &&
         longitude_deg >= -kMostLongitude_deg && longitude_deg <= kMostLongitude_deg;
}

}  // namespace bevloc
