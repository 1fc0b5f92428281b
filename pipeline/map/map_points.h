// Functions on all points of a map.
#pragma once

#include <Eigen/Geometry>

#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Replaces every point of the elements and lanes by move(point).
template <typename Move>
void move_points(HdMap& map, const Move& move) {
  const auto move_all = [&move](std::vector<Eigen::Vector2d>& points) {
    for (Eigen::Vector2d& point : points) point = move(point);
  };
  for (MapElement& element : map.elements) move_all(element.points);
  for (Lane& lane : map.lanes) {
    move_all(lane.left);
    move_all(lane.right);
    move_all(lane.centerline);
  }
}

/// The box around the points of all elements. It is empty if there are none.
inline Eigen::AlignedBox2d bounds_of(const HdMap& map) {
  Eigen::AlignedBox2d box;
  for (const MapElement& element : map.elements) {
    for (const Eigen::Vector2d& point : element.points) box.extend(point);
  }
  return box;
}

}  // namespace bevloc
