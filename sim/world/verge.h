// Lets grass or dirt grow over the edge of the road, inside of the mapped boundaries.
#pragma once

#include <functional>

#include "sim/world/world.h"

namespace bevloc::sim {

struct Verge {
  double width_m = 0.0;  ///< how far it reaches into the road; 0 without a verge
  GroundMaterial material = GroundMaterial::kGrass;
};

/// Calls `verge_of` for each boundary of the world's map that has a lane beside it. A verge ends
/// before the middle of the lane, so that vehicles stay on the road. The map does not change.
void grow_verges(World& world, const std::function<Verge()>& verge_of);

}  // namespace bevloc::sim
