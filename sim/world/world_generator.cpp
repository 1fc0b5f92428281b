#include "sim/world/world_generator.h"

#include "sim/world/parking.h"
#include "sim/world/road_edges.h"
#include "sim/world/road_markings.h"
#include "sim/world/road_network.h"
#include "sim/world/scenery.h"
#include "sim/world/town_lanes.h"
#include "sim/world/traffic.h"
#include "sim/world/world_builder.h"

namespace bevloc::sim {
namespace {

std::vector<Roadside> roadsides_of(const RoadNetwork& network) {
  std::vector<Roadside> roadsides;
  for (const Road& road : network.roads) {
    for (size_t i = 0; i < 2; ++i) {
      const Carriageway& side = road.sides[i];
      roadsides.push_back(
          {side.path.parallel(side.begin_m, side.end_m, [&](double s) { return side.kerb(s); }),
           road.style.edges[i].verge_m + road.style.edges[i].sidewalk_m});
    }
  }
  return roadsides;
}

GeoOrigin random_origin(Random& random) {
  const double latitude = random.uniform(25.0, 60.0) * (random.chance(0.8) ? 1.0 : -1.0);
  return {latitude, random.uniform(-180.0, 180.0)};
}

void mirror(Polyline& line) {
  for (Eigen::Vector2d& point : line) point.y() = -point.y();
}

void mirror(VehicleBody& body) {
  body.centre.y() = -body.centre.y();
  body.yaw_rad = -body.yaw_rad;
}

/// Turns a town with right-hand traffic into one with left-hand traffic.
void mirror(World& world) {
  for (MapElement& element : world.map.elements) mirror(element.points);
  for (Lane& lane : world.map.lanes) {
    std::swap(lane.left, lane.right);
    mirror(lane.left);
    mirror(lane.right);
    mirror(lane.centerline);
  }
  for (Surface& surface : world.surfaces) mirror(surface.ring);
  for (PaintLine& line : world.paint_lines) mirror(line.points);
  for (PaintArea& area : world.paint_areas) mirror(area.ring);
  for (Wall& wall : world.walls) mirror(wall.base);
  for (VehicleBody& body : world.parked) mirror(body);
  for (TrafficVehicle& vehicle : world.traffic) mirror(vehicle.path);
  for (Post& post : world.posts) post.position.y() = -post.position.y();
}

}  // namespace

World generate_world(uint64_t seed) {
  Random style_random(seed_for(seed, "town style"));
  const TownStyle town = random_town_style(style_random);
  Random plan_random(seed_for(seed, "town plan"));
  const RoadNetwork network = make_road_network(town, plan_random);

  Random build_random(seed_for(seed, "town build"));
  WorldBuilder builder(town, build_random);
  builder.world().seed = seed;
  builder.world().background = town.background;
  builder.world().map.name = "town-" + std::to_string(seed);
  builder.world().map.origin = random_origin(build_random);
  add_lanes(network, builder.world().map);
  add_road_edges(network, builder);
  add_junction_edges(network, builder);
  add_road_markings(network, builder);
  add_crossings(network, builder);
  add_parked_vehicles(network, builder);
  add_scenery(roadsides_of(network), {}, builder);
  builder.world().traffic = random_traffic(builder.world().map, town.traffic_density, build_random);
  World world = builder.finish();
  if (town.left_hand_traffic) mirror(world);
  return world;
}

}  // namespace bevloc::sim
