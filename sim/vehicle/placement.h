// Draws random vehicle poses on the roads of a world.
#pragma once

#include <span>

#include "common/se2.h"
#include "sim/random.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// A random pose on the lanes of the world's map, which must have lanes. Most poses follow the
/// lane, some lie between two lanes or at an angle, as in a lane change. The pose has at least two
/// map elements within 30 m; if 30 attempts find no such pose, the last one is returned.
Se2 random_pose_on_road(const World& world, Random& random);

/// Whether the pose differs from each of `others` by more than 15 m or more than 60 degrees, so
/// that the cameras see something different.
bool is_apart(const Se2& pose, std::span<const Se2> others);

}  // namespace bevloc::sim
