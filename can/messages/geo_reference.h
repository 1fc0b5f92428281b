// Converts poses between the map frame and WGS84.
#pragma once

#include <vector>

#include <GeographicLib/LocalCartesian.hpp>

#include "common/se2.h"

namespace bevloc::can {

/// A WGS84 position in degrees.
struct GeodeticPosition {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

/// A position on the ground and a heading, in the units of the CAN signals.
struct GeodeticPose {
  GeodeticPosition position;
  double heading_deg = 0.0;  ///< clockwise from true north, in [0, 360)
};

/// Converts between the map frame and WGS84. The map frame is the east-north plane that touches the
/// ellipsoid at the origin of the map. A point of the map stands for the ground below it, at
/// ellipsoidal height 0, so that the two conversions are inverse to each other at any distance from
/// the origin. Headings account for the convergence of the meridians: east or west of the origin,
/// true north differs from the map's north. Input that is not finite gives output that is not
/// finite. Does not allocate after construction. One thread.
class GeoReference {
 public:
  /// `origin` is the WGS84 position of the map's origin.
  explicit GeoReference(GeodeticPosition origin);

  /// `map_from_vehicle`: metres east and north, yaw counter-clockwise from east.
  GeodeticPose geodetic_from_map(const Se2& map_from_vehicle);
  Se2 map_from_geodetic(const GeodeticPose& pose);

 private:
  GeographicLib::LocalCartesian plane_;
  /// Rotation from local east, north, up to the axes of the map: 3x3, row by row.
  std::vector<double> map_from_local_;
};

}  // namespace bevloc::can
