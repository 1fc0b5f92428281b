// Generates worlds: a town from a seed, or a world dressed on an imported map.
#pragma once

#include <cstdint>

#include "sim/world/world.h"

namespace bevloc::sim {

/// Training uses only seeds from here up; demos, tests and evaluations use only smaller seeds. So
/// nothing is evaluated on a town that was trained on.
inline constexpr uint64_t kFirstTrainingSeed = 1ULL << 32U;

/// Generates a town of a few hundred metres: straight and curved roads with one to three lanes per
/// direction, junctions with crossings, merges, roundabouts. Every lane of its map has a successor,
/// so a vehicle can drive without end.
World generate_world(uint64_t seed);

/// Dresses an imported map: adds surfaces, paint by appearance, walls, scenery and traffic.
World world_from_map(const HdMap& map, uint64_t seed);

}  // namespace bevloc::sim
