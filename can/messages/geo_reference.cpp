#include "can/messages/geo_reference.h"

#include <cmath>

namespace bevloc::can {

GeoReference::GeoReference(GeodeticPosition origin)
    : plane_(origin.latitude_deg, origin.longitude_deg), map_from_local_(9) {}

GeodeticPose GeoReference::geodetic_from_map(const Se2& map_from_vehicle) {
  GeodeticPose pose;
  auto& [latitude_deg, longitude_deg] = pose.position;
  // The height of the plane above the ground grows with the square of the distance. Each step
  // subtracts the remaining height. After two steps it is below a micrometre within 100 km.
  double up_m = 0.0;
  for (int step = 0; step < 3; ++step) {
    double height_m = 0.0;
    plane_.Reverse(map_from_vehicle.x_m, map_from_vehicle.y_m, up_m, latitude_deg, longitude_deg,
                   height_m, map_from_local_);
    up_m -= height_m;
  }
  // This is, up to a factor, the inverse of the conversion of the direction in map_from_geodetic().
  const auto& r = map_from_local_;
  const double x = std::cos(map_from_vehicle.yaw_rad);
  const double y = std::sin(map_from_vehicle.yaw_rad);
  const double heading_deg = degrees(std::atan2(r[4] * x - r[1] * y, r[0] * y - r[3] * x));
  pose.heading_deg = heading_deg < 0.0 ? heading_deg + 360.0 : heading_deg;
  return pose;
}

Se2 GeoReference::map_from_geodetic(const GeodeticPose& pose) {
  Se2 map_from_vehicle;
  double up_m = 0.0;
  plane_.Forward(pose.position.latitude_deg, pose.position.longitude_deg, 0.0, map_from_vehicle.x_m,
                 map_from_vehicle.y_m, up_m, map_from_local_);
  const auto& r = map_from_local_;
  const double east = std::sin(radians(pose.heading_deg));
  const double north = std::cos(radians(pose.heading_deg));
  map_from_vehicle.yaw_rad = std::atan2(r[3] * east + r[4] * north, r[0] * east + r[1] * north);
  return map_from_vehicle;
}

}  // namespace bevloc::can
