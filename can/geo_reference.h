// Where the map lies on the earth.
#pragma once

#include <vector>

#include <GeographicLib/LocalCartesian.hpp>

#include "common/se2.h"

namespace bevloc::can {

/// WGS84, degrees.
struct GeodeticPosition {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

/// A place on the ground and a direction there, as the bus has them.
struct GeodeticPose {
  GeodeticPosition position;
  double heading_deg = 0.0;  ///< clockwise from true north, in [0, 360)
};

/// Converts between the map frame (the east-north plane that touches the ellipsoid at the map's
/// origin) and WGS84. A point of the map stands for the ground below it, at ellipsoidal height 0,
/// so that both directions agree however far the origin is. True north turns against the map's
/// north as one goes east or west; the headings take that into account. Not finite in, not finite
/// out. Does not allocate after construction. One thread at a time.
class GeoReference {
 public:
  /// `origin` is the WGS84 position of the map's origin.
  explicit GeoReference(GeodeticPosition origin);

  /// `map_from_vehicle`: metres east and north, yaw counter-clockwise from east.
  GeodeticPose geodetic_from_map(const Se2& map_from_vehicle);
  Se2 map_from_geodetic(const GeodeticPose& pose);

 private:
  GeographicLib::LocalCartesian plane_;
  /// Rotation from east, north, up at a place to the axes of the map, row by row.
  std::vector<double> map_from_local_;
};

}  // namespace bevloc::can
