// Small maps for tests: roads along the x axis of the map, seen from its origin.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "common/se2.h"
#include "pipeline/map/hd_map.h"
#include "sim/perception/dashed_line.h"
#include "sim/world/path.h"

namespace bevloc::sim {

inline void add_line(HdMap& map, ElementClass element_class, Polyline points) {
  MapElement element;
  element.element_class = element_class;
  element.points = std::move(points);
  map.elements.push_back(std::move(element));
}

inline void add_kerb(HdMap& map, Polyline points) {
  add_line(map, ElementClass::kRoadBoundary, std::move(points));
}

inline void add_divider(HdMap& map, Polyline points) {
  add_line(map, ElementClass::kLaneDivider, std::move(points));
}

/// A crossing over the whole road, 3 m wide.
inline void add_crossing(HdMap& map, double x_m) {
  add_line(map, ElementClass::kPedestrianCrossing,
           {{x_m, -6.0}, {x_m + 3.0, -6.0}, {x_m + 3.0, 6.0}, {x_m, 6.0}});
}

inline Polyline along_x(double from_m, double to_m, double y_m) {
  return {{from_m, y_m}, {to_m, y_m}};
}

/// Kerbs 6 m to either side and a divider between them, through the whole box.
inline HdMap open_road() {
  HdMap map;
  add_kerb(map, along_x(-80.0, 80.0, 6.0));
  add_divider(map, along_x(-80.0, 80.0, 0.0));
  add_kerb(map, along_x(-80.0, 80.0, -6.0));
  return map;
}

/// The dashes of a line from x = -80 m to 80 m: 3 m long with gaps of 5 m, the first at -80 m.
inline std::vector<Dash> regular_dashes() {
  std::vector<Dash> dashes;
  for (double from_m = 0.0; from_m < 160.0; from_m += 8.0) dashes.push_back({from_m, from_m + 3.0});
  return dashes;
}

/// Part of a circle around a point, counter-clockwise.
inline Polyline arc(const Eigen::Vector2d& centre, double radius_m, double from_rad,
                    double to_rad) {
  constexpr int kPieces = 60;
  Polyline points;
  for (int k = 0; k <= kPieces; ++k) {
    points.emplace_back(centre +
                        radius_m * unit_vector(from_rad + (to_rad - from_rad) * k / kPieces));
  }
  return points;
}

}  // namespace bevloc::sim
