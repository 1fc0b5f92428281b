// Vehicles: parked ones and moving ones.
#pragma once

#include "sim/random.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// A vehicle of random kind, size and colour; its place is left at the origin.
VehicleBody random_vehicle(Random& random);

/// Vehicles on random routes along the lanes; `density` is in vehicles per 100 m of lane.
std::vector<TrafficVehicle> random_traffic(const HdMap& map, double density, Random& random);

}  // namespace bevloc::sim
