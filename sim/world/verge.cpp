#include "sim/world/verge.h"

#include <algorithm>

#include "sim/world/path.h"
#include "sim/world/road_side.h"

namespace bevloc::sim {
namespace {

/// A verge ends this far from the centre line of a lane.
constexpr double kBesideLane_m = 1.0;

}  // namespace

void grow_verges(World& world, const std::function<Verge()>& verge_of) {
  const RoadSide road(world.map);
  for (const MapElement& element : world.map.elements) {
    if (element.element_class != ElementClass::kRoadBoundary) continue;
    if (element.points.size() < 2 || polyline_length(element.points) <= 0.0) continue;
    const Path path(element.points);
    const auto side = road.of(path);
    if (!side) continue;
    const Verge verge = verge_of();
    const double width_m = std::min(verge.width_m, side->distance_m - kBesideLane_m);
    if (width_m <= 0.0) continue;
    Surface surface{verge.material, 1.0F, path.points()};
    append(surface.ring,
           reversed(path.parallel(0.0, path.length_m(), side->is_right ? width_m : -width_m)));
    world.surfaces.push_back(std::move(surface));
  }
}

}  // namespace bevloc::sim
