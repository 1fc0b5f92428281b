// The map of one straight road, for tests of what changes maps and worlds.
#pragma once

#include "pipeline/map/hd_map.h"
#include "sim/world/world.h"

namespace bevloc::sim {

inline constexpr double kLength_m = 100.0;

inline Polyline straight(double y) {
  return {{0.0, y}, {kLength_m, y}};
}

/// One lane towards the east, a divider on its left, a boundary on its right, and a crossing.
inline HdMap straight_road() {
  HdMap map;
  map.elements = {
      {ElementClass::kLaneDivider, Appearance::kDashed, straight(0.0)},
      {ElementClass::kRoadBoundary, Appearance::kKerb, straight(-4.0)},
      {ElementClass::kPedestrianCrossing,
       Appearance::kZebra,
       {{50.0, -4.0}, {54.0, -4.0}, {54.0, 0.0}, {50.0, 0.0}}},
  };
  Lane lane;
  lane.left = straight(0.0);
  lane.right = straight(-3.5);
  lane.centerline = straight(-1.75);
  map.lanes = {lane};
  return map;
}

}  // namespace bevloc::sim
