// Random vehicles and random moving traffic.
#pragma once

#include "sim/random.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// A vehicle of random kind, size and colour, placed at the origin.
VehicleBody random_vehicle(Random& random);

/// Vehicles on random routes along the lanes of the map. `density` is the number of vehicles per
/// 100 m of lane.
std::vector<TrafficVehicle> random_traffic(const HdMap& map, double density, Random& random);

}  // namespace bevloc::sim
