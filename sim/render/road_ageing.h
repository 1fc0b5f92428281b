// Generates traces of traffic and weather on roads: tracks, cracks, patches.
#pragma once

#include <vector>

#include "sim/render/stroke.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// A repaired piece of road, lighter or darker by the factor `shade`.
struct RoadPatch {
  Ring ring;
  float shade = 1.0F;
};

struct RoadAgeing {
  std::vector<RoadPatch> patches;
  /// StrokeSegment::line of tracks and cracks is an index into this.
  std::vector<Soiling> soilings;
  std::vector<StrokeSegment> tracks;
  std::vector<StrokeSegment> cracks;
};

/// Ages every lane of the world's map, with the world's seed.
RoadAgeing age_roads(const World& world);

}  // namespace bevloc::sim
