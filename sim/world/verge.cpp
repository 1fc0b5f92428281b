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
  for (const auto& [element, path, side] : boundaries_beside_road(world.map)) {
    const Verge verge = verge_of();
    const double width_m = std::min(verge.width_m, side.distance_m - kBesideLane_m);
    if (width_m <= 0.0) continue;
    Surface surface{verge.material, 1.0F, path.points()};
    append(surface.ring,
           reversed(path.parallel(0.0, path.length_m(), side.is_right ? width_m : -width_m)));
    world.surfaces.push_back(std::move(surface));
  }
}

}  // namespace bevloc::sim
