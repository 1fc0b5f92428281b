#include "sim/faults/world_faults.h"

#include "sim/world/verge.h"

namespace bevloc::sim {

World with_faults(World world, std::span<const Fault> faults) {
  for (const Fault& fault : faults) {
    if (fault.kind != FaultKind::kWorldGrass) continue;
    grow_verges(world, [&fault] { return Verge{.width_m = fault.amounts.inside_m}; });
  }
  return world;
}

}  // namespace bevloc::sim
