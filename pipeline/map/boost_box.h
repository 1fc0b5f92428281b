// The boxes of the spatial indexes.
#pragma once

#include <Eigen/Core>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>

namespace bevloc {

using BoostPoint = boost::geometry::model::point<double, 2, boost::geometry::cs::cartesian>;
using BoostBox = boost::geometry::model::box<BoostPoint>;

inline BoostBox box_of(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  return {{low.x(), low.y()}, {high.x(), high.y()}};
}

}  // namespace bevloc
