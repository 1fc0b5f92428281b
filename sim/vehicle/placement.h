// Where a training sample's vehicle stands.
#pragma once

#include "common/se2.h"
#include "sim/random.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// A vehicle somewhere on the lanes of the world's map, which must have some: mostly as one drives,
/// now and then between two lanes or askew. Where fewer than two map elements lie within 30 m, it
/// looks for another place (and gives up after many).
Se2 random_pose_on_road(const World& world, Random& random);

}  // namespace bevloc::sim
