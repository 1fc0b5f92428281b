#include "firmware/simulation/configured_world.h"

#include "pipeline/map/map_loader.h"
#include "sim/world/world_generator.h"

namespace bevloc::firmware {

Result<sim::World> make_configured_world(const MapConfig& config, uint64_t seed) {
  if (config.procedural_seed) return sim::generate_world(*config.procedural_seed);
  auto map = load_map(config.file);
  if (!map) return tl::unexpected(map.error());
  if (map->lanes.empty()) {
    return fail("{}: found no lanes, wanted some to drive on", config.file.string());
  }
  return sim::world_from_map(*map, seed);
}

}  // namespace bevloc::firmware
