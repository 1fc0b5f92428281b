#include "sim/world/parking.h"

#include <numbers>

#include "sim/world/traffic.h"

namespace bevloc::sim {
namespace {

constexpr double kCrosswiseBelow_m = 3.0;  ///< in shorter bays vehicles stand crosswise
constexpr double kKerbsideSpacing_m = 5.8;

void park(const Carriageway& side, double station_m, double right_m, WorldBuilder& builder) {
  Random& random = builder.random();
  VehicleBody body = random_vehicle(random);
  const bool reversed = random.chance(0.15);
  const double station = station_m + random.normal(0.0, 0.03 * side.bay_m);
  const double offset = right_m + random.normal(0.0, 0.1);
  const double skew = random.normal(0.0, 0.02);
  const bool crosswise = side.parking_m > 0.0 && side.bay_m < kCrosswiseBelow_m;
  if (body.length_m > (crosswise ? 5.0 : 5.6)) return;
  body.centre = side.path.beside(station, offset);
  body.yaw_rad = side.path.heading_rad(station) + (reversed ? std::numbers::pi : 0.0) +
                 (crosswise ? 0.5 * std::numbers::pi : 0.0) + skew;
  builder.world().parked.push_back(body);
}

void park_in_bays(const Carriageway& side, WorldBuilder& builder) {
  const Interval bays = side.bays();
  const double half_m = 0.5 * side.bay_m;
  for (double s = bays.begin_m + half_m; s + half_m <= bays.end_m; s += side.bay_m) {
    if (!builder.random().chance(builder.town().parking_occupancy)) continue;
    park(side, s, side.lanes_edge(s) + 0.5 * side.parking_m, builder);
  }
}

/// Vehicles that stand half on the pavement.
void park_on_kerb(const Carriageway& side, WorldBuilder& builder) {
  for (double s = side.begin_m + 12.0; s < side.end_m - 12.0; s += kKerbsideSpacing_m) {
    if (!builder.random().chance(0.4 * builder.town().parking_occupancy)) continue;
    park(side, s, side.kerb(s) + 0.4, builder);
  }
}

/// Whether there is a kerb with enough room behind it.
bool has_room_on_kerb(const EdgeStyle& edge) {
  return edge.boundary == Appearance::kKerb && edge.verge_m + edge.sidewalk_m > 1.5;
}

}  // namespace

void add_parked_vehicles(const RoadNetwork& network, WorldBuilder& builder) {
  for (const Road& road : network.roads) {
    for (size_t i = 0; i < 2; ++i) {
      const Carriageway& side = road.sides[i];
      const bool on_kerb = has_room_on_kerb(road.style.edges[i]) &&
                           builder.random().chance(0.5 * builder.town().parking_chance);
      if (side.parking_m > 0.0) {
        park_in_bays(side, builder);
      } else if (on_kerb) {
        park_on_kerb(side, builder);
      }
    }
  }
}

}  // namespace bevloc::sim
