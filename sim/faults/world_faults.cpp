#include "sim/faults/world_faults.h"

#include <algorithm>

#include "sim/faults/road_side.h"

namespace bevloc::sim {
namespace {

/// Grass ends this far from the centre line of a lane, so that the vehicle stays on the road.
constexpr double kBesideLane_m = 1.0;

/// Covers the road beside each of its mapped boundaries with grass.
void grow_grass(World& world, double inside_m) {
  const RoadSide road(world.map);
  for (const MapElement& element : world.map.elements) {
    if (element.element_class != ElementClass::kRoadBoundary) continue;
    if (element.points.size() < 2 || length_m(element.points) <= 0.0) continue;
    const Path path(element.points);
    const auto side = road.of(path);
    if (!side) continue;
    const double width_m = std::min(inside_m, side->distance_m - kBesideLane_m);
    if (width_m <= 0.0) continue;
    Surface grass{GroundMaterial::kGrass, 1.0F, path.points()};
    append(grass.ring,
           reversed(path.parallel(0.0, path.length_m(), side->is_right ? width_m : -width_m)));
    world.surfaces.push_back(std::move(grass));
  }
}

}  // namespace

World with_faults(World world, std::span<const Fault> faults) {
  for (const Fault& fault : faults) {
    if (fault.kind == FaultKind::kWorldGrass) grow_grass(world, fault.amounts.inside_m);
  }
  return world;
}

}  // namespace bevloc::sim
