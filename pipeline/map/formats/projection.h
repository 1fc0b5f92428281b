// Converts between a file's plane coordinates and latitude and longitude.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// The plane of a map file: x points to the east, y to the north, in metres. Immutable, and so
/// thread-safe.
class Projection {
 public:
  virtual ~Projection() = default;
  /// Latitude and longitude of a point of the file.
  virtual GeoOrigin geographic(const Eigen::Vector2d& point) const = 0;
  /// How far a point of the file lies from the meridian in the middle of the plane, in metres. 0 if
  /// the plane has no such meridian.
  virtual double distance_from_meridian_m(const Eigen::Vector2d& /*point*/) const { return 0.0; }
};

/// Reads a PROJ string. Understands +proj=utm (+zone, +south), +proj=tmerc (+lat_0, +lon_0, +k or
/// +k_0, +x_0, +y_0) and the EPSG codes of UTM zones (+init=epsg:326xx, 327xx and 258xx), on WGS84
/// or GRS80 in metres. Takes ETRS89 and NAD83 as WGS84. Refuses words that it does not know.
/// Returns null for +proj=longlat or latlong, which do not say where a plane in metres lies. The
/// error says what is not understood, without a file name.
Result<std::unique_ptr<Projection>> projection_from_proj(std::string_view text);

/// UTM north or south of the equator, with `offset` added to the coordinates of the file.
std::unique_ptr<Projection> utm_projection(int zone, bool north, const Eigen::Vector2d& offset);

/// The point of a UTM zone (north) that has this place on earth.
Eigen::Vector2d utm_point(const GeoOrigin& place, int zone);

/// The tangent plane at a place on earth.
std::unique_ptr<Projection> tangent_projection(const GeoOrigin& origin);

/// `inner` after a rotation by `yaw_rad` and a shift of the coordinates of the file.
std::unique_ptr<Projection> moved_projection(std::unique_ptr<Projection> inner,
                                             const Eigen::Vector2d& shift, double yaw_rad);

}  // namespace bevloc
