// Makes a whole town from a seed.
#pragma once

#include <cstdint>

#include "sim/world/world.h"

namespace bevloc::sim {

/// Seeds from here up are the only ones that training may use, those below the only ones that
/// demos, tests and evaluations may use: the two sets are apart by construction.
inline constexpr uint64_t kFirstTrainingSeed = 1ULL << 32U;

/// A town of a few hundred metres: straight and curved roads with one to three lanes a side,
/// junctions with crossings, merges, a roundabout. Its map has lanes with successors, so that a
/// vehicle can drive through it for ever.
World generate_world(uint64_t seed);

/// Dresses an imported map (surfaces, paint by appearance, walls, traffic): a world to drive in.
World world_from_map(const HdMap& map, uint64_t seed);

}  // namespace bevloc::sim
