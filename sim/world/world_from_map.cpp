#include <algorithm>

#include "sim/world/ground_mask.h"
#include "sim/world/paving.h"
#include "sim/world/scenery.h"
#include "sim/world/traffic.h"
#include "sim/world/world_builder.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {
namespace {

constexpr double kShortestLine_m = 0.3;

/// The area up to `reach_m` on both sides of a line.
Ring area_beside(const Path& line, double reach_m) {
  Ring ring = line.parallel(0.0, line.length_m(), -reach_m);
  append(ring, reversed(line.parallel(0.0, line.length_m(), reach_m)));
  return ring;
}

/// Builds the world around an imported map.
class MapDresser {
 public:
  MapDresser(const HdMap& map, const TownStyle& town, Random& random)
      : map_(map), town_(town), random_(random), builder_(town, random) {}

  World dress(uint64_t seed) {
    lay_asphalt();
    for (const MapElement& element : map_.elements) show(element);
    const std::vector<Roadside> roadsides = find_roadsides();
    std::vector<Polyline> boundaries;
    for (const MapElement& element : map_.elements) {
      if (element.element_class == ElementClass::kRoadBoundary)
        boundaries.push_back(element.points);
    }
    add_scenery(roadsides, boundaries, builder_);
    World world = builder_.finish();
    world.seed = seed;
    world.map = map_;
    world.background = town_.background;
    world.traffic = random_traffic(map_, 0.5 * town_.traffic_density, random_);
    return world;
  }

 private:
  void lay_asphalt();
  void show(const MapElement& element);
  void show_divider(const MapElement& element);
  void show_boundary(const MapElement& element);
  /// Finds the boundaries with open land on one side and turns them so that it lies on the right.
  std::vector<Roadside> find_roadsides();
  void park_beside(const Path& edge);

  const HdMap& map_;
  const TownStyle& town_;
  Random& random_;
  WorldBuilder builder_;
};

void MapDresser::lay_asphalt() {
  const auto brightness = static_cast<float>(random_.uniform(0.75, 1.25));
  const auto lay = [&](const Ring& ring) {
    builder_.add_surface(Layer::kCarriageway, ring, GroundMaterial::kAsphalt, brightness);
  };
  for (const Ring& ring : paved_rings(map_)) lay(ring);
  if (!map_.lanes.empty()) return;
  // Without lanes, crossings are paved, and each divider is taken to have a lane on either side.
  for (const MapElement& element : map_.elements) {
    if (element.element_class == ElementClass::kPedestrianCrossing) lay(element.points);
    if (element.element_class != ElementClass::kLaneDivider) continue;
    if (polyline_length(element.points) < kShortestLine_m) continue;
    lay(area_beside(Path(element.points), town_.lane_width_m));
  }
}

void MapDresser::show(const MapElement& element) {
  if (element.element_class == ElementClass::kPedestrianCrossing) {
    const bool known = element.appearance != Appearance::kUnknown;
    builder_.paint_crossing(element.points, known ? element.appearance : Appearance::kZebra,
                            static_cast<float>(town_.wear));
    return;
  }
  if (polyline_length(element.points) < kShortestLine_m) return;
  if (element.element_class == ElementClass::kLaneDivider) {
    show_divider(element);
  } else {
    show_boundary(element);
  }
}

void MapDresser::show_divider(const MapElement& element) {
  DividerPaint paint{.appearance = element.appearance,
                     .width_m = random_.uniform(0.11, 0.16),
                     .dash_m = town_.dash_m,
                     .gap_m = town_.gap_m};
  if (paint.appearance == Appearance::kUnknown) {
    paint.appearance = random_.chance(0.6) ? Appearance::kDashed : Appearance::kSolid;
  }
  builder_.paint_divider(element.points, paint, static_cast<float>(town_.wear));
}

void MapDresser::show_boundary(const MapElement& element) {
  EdgeStyle edge;
  edge.boundary =
      element.appearance == Appearance::kUnknown ? Appearance::kKerb : element.appearance;
  edge.kerb = town_.kerb;
  edge.kerb_height_m = town_.kerb_height_m;
  builder_.build_boundary(element.points, edge);
}

std::vector<Roadside> MapDresser::find_roadsides() {
  constexpr double kProbe_m = 4.0;
  constexpr double kOpen_m = 2.5;
  const GroundMask mask(builder_.paved_rings());
  std::vector<Roadside> roadsides;
  for (const MapElement& element : map_.elements) {
    if (element.element_class != ElementClass::kRoadBoundary) continue;
    if (polyline_length(element.points) < 3.0) continue;
    Path edge(element.points);
    const double middle_m = 0.5 * edge.length_m();
    const double right_m = mask.distance_to_paved_m(edge.beside(middle_m, kProbe_m));
    const double left_m = mask.distance_to_paved_m(edge.beside(middle_m, -kProbe_m));
    if (std::max(right_m, left_m) < kOpen_m) continue;
    if (left_m > right_m) edge = edge.reversed();
    const bool kerb =
        element.appearance == Appearance::kKerb || element.appearance == Appearance::kUnknown;
    const double sidewalk_m = kerb && random_.chance(0.6) ? random_.uniform(1.5, 3.0) : 0.0;
    if (sidewalk_m > 0.0) {
      Ring ring = edge.points();
      append(ring, reversed(edge.parallel(0.0, edge.length_m(), sidewalk_m)));
      builder_.add_surface(Layer::kSidewalk, ring, town_.sidewalk);
    }
    if (kerb && random_.chance(0.1)) park_beside(edge);
    roadsides.push_back({edge.points(), sidewalk_m});
  }
  return roadsides;
}

/// Parks a few vehicles half on the kerb.
void MapDresser::park_beside(const Path& edge) {
  for (double s = 5.0; s + 5.0 < edge.length_m(); s += 6.5) {
    VehicleBody body = random_vehicle(random_);
    if (body.kind != VehicleKind::kCar || random_.chance(0.5)) continue;
    body.centre = edge.beside(s, 0.5 * body.width_m - 0.3);
    body.yaw_rad = edge.heading_rad(s);
    builder_.world().parked.push_back(body);
  }
}

}  // namespace

World world_from_map(const HdMap& map, uint64_t seed) {
  Random random(seed_for(seed, "dressed map"));
  const TownStyle town = random_town_style(random);
  return MapDresser(map, town, random).dress(seed);
}

}  // namespace bevloc::sim
