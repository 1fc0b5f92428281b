#include "pipeline/map/tangent_plane.h"

namespace bevloc {

GeoOrigin place_of(const GeographicLib::LocalCartesian& plane, const Eigen::Vector2d& point) {
  // At 100 km each round divides the error by about 8,000.
  constexpr int kRounds = 3;
  GeoOrigin place;
  double up_m = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    double height_m = 0.0;
    plane.Reverse(point.x(), point.y(), up_m, place.latitude_deg, place.longitude_deg, height_m);
    up_m -= height_m;
  }
  return place;
}

Eigen::Vector2d point_of(const GeographicLib::LocalCartesian& plane, const GeoOrigin& place) {
  // The ground is this far below the plane at 160 km, which is farther than any map reaches.
  constexpr double kHorizon_m = -2'000.0;
  Eigen::Vector3d point;
  plane.Forward(place.latitude_deg, place.longitude_deg, 0.0, point.x(), point.y(), point.z());
  if (point.z() < kHorizon_m) return {point.norm(), 0.0};
  return point.head<2>();
}

}  // namespace bevloc
