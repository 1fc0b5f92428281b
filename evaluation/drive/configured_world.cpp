#include "evaluation/drive/configured_world.h"

#include "pipeline/map/map_loader.h"
#include "sim/random.h"
#include "sim/world/world_generator.h"

namespace bevloc::evaluation {

Result<sim::World> make_configured_world(const DriveConfig& config) {
  const SimulationConfig simulation = config.simulation.value_or(SimulationConfig());
  if (simulation.town_seed) return sim::generate_world(*simulation.town_seed);
  auto map = load_map(config.map_file);
  if (!map) return tl::unexpected(map.error());
  if (map->lanes.empty()) {
    return fail("{}: found no lanes, wanted some to drive on", config.map_file.string());
  }
  return sim::world_from_map(*map, simulation.seed);
}

std::shared_ptr<const sim::Drive> make_configured_drive(const sim::World& world,
                                                        const SimulationConfig& simulation,
                                                        double added_s) {
  return std::make_shared<const sim::Drive>(world, sim::seed_for(simulation.seed, "drive"),
                                            simulation.duration_s + added_s, simulation.stops,
                                            simulation.pace);
}

}  // namespace bevloc::evaluation
