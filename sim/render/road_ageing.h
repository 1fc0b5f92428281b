// What traffic and weather leave on a road: tracks, cracks, tar patches.
#pragma once

#include <vector>

#include "sim/render/stroke.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// A piece of road mended with another mix, lighter or darker by `shade`.
struct RoadPatch {
  Ring ring;
  float shade = 1.0F;
};

struct RoadAgeing {
  std::vector<RoadPatch> patches;
  /// StrokeSegment::line of tracks and cracks counts here.
  std::vector<Soiling> soilings;
  std::vector<StrokeSegment> tracks;
  std::vector<StrokeSegment> cracks;
};

/// Ages every lane of the world's map, by the world's seed.
RoadAgeing age_roads(const World& world);

}  // namespace bevloc::sim
