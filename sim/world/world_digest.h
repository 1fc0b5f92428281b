// A number that stands for everything that the cameras can see of a world.
#pragma once

#include <cstdint>

#include "sim/world/world.h"

namespace bevloc::sim {

/// Worlds that look different have different digests. The map does not count.
uint64_t digest_of(const World& world);

}  // namespace bevloc::sim
