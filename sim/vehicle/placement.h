// Where a training sample's vehicle stands.
#pragma once

#include <span>

#include "common/se2.h"
#include "sim/random.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// A vehicle somewhere on the lanes of the world's map, which must have some: mostly as one drives,
/// now and then between two lanes or askew. Where fewer than two map elements lie within 30 m, it
/// looks for another place (and gives up after many).
Se2 random_pose_on_road(const World& world, Random& random);

/// Whether a pose is more than 15 m away from each other one, or turned by more than 60 degrees
/// against it, so that the cameras see something else.
bool is_apart(const Se2& pose, std::span<const Se2> others);

}  // namespace bevloc::sim
