#include "sim/world/town_style.h"

#include <algorithm>
#include <array>

namespace bevloc::sim {
namespace {

constexpr Rgb kCentreYellow{0.72F, 0.55F, 0.12F};

struct DashPattern {
  double dash_m;
  double gap_m;
};

/// Dash patterns of Europe, North America and Asia.
constexpr std::array<DashPattern, 8> kDashPatterns{{{3.0, 9.0},
                                                    {3.0, 6.0},
                                                    {6.0, 12.0},
                                                    {2.0, 4.0},
                                                    {4.0, 8.0},
                                                    {1.5, 1.5},
                                                    {3.0, 3.0},
                                                    {2.0, 6.0}}};

Rgb white_paint(Random& random) {
  const double value = random.uniform(0.62, 0.9);
  return {static_cast<float>(value), static_cast<float>(value),
          static_cast<float>(value * random.uniform(0.92, 1.0))};
}

WallTexture random_kerb(Random& random) {
  const double draw = random.uniform();
  if (draw < 0.7) return WallTexture::kKerbPlain;
  return draw < 0.88 ? WallTexture::kKerbStriped : WallTexture::kKerbPainted;
}

Appearance random_hard_edge(Random& random) {
  constexpr std::array kKinds{Appearance::kBarrier, Appearance::kGuardRail, Appearance::kWall,
                              Appearance::kFence, Appearance::kHedge};
  return kKinds[random.index(kKinds.size())];
}

EdgeStyle random_edge(const TownStyle& town, Random& random) {
  EdgeStyle edge;
  edge.kerb = random.chance(0.8) ? town.kerb : random_kerb(random);
  edge.kerb_height_m = std::clamp(town.kerb_height_m + random.normal(0.0, 0.02), 0.03, 0.25);
  const double draw = random.uniform();
  if (draw < 0.45 + 0.45 * town.urbanity) {
    edge.boundary = Appearance::kKerb;
    edge.verge_m = random.chance(0.35) ? random.uniform(0.5, 3.0) : 0.0;
    edge.sidewalk_m = random.chance(0.5 + 0.45 * town.urbanity) ? random.uniform(1.2, 4.5) : 0.0;
    edge.driveways_per_100m = random.chance(0.6) ? random.uniform(0.0, 4.0) : 0.0;
  } else if (draw < 0.85) {
    edge.boundary = Appearance::kRoadEdge;
    edge.sidewalk_m = 0.0;
    edge.driveways_per_100m = random.chance(0.5) ? random.uniform(0.0, 3.0) : 0.0;
  } else {
    edge.boundary = random_hard_edge(random);
    edge.sidewalk_m = random.chance(0.4) ? random.uniform(1.2, 3.0) : 0.0;
  }
  return edge;
}

void draw_lane_counts(const TownStyle& town, Random& random, RoadStyle& road) {
  const double size = random.uniform() + 0.15 * town.urbanity;
  const int lanes = size < 0.6 ? 1 : (size < 0.95 ? 2 : 3);
  road.lanes_forward = lanes;
  road.lanes_backward = lanes;
  if (random.chance(0.15)) {
    road.lanes_backward = 0;
    road.lanes_forward = std::min(3, lanes + random.integer(0, 1));
  } else if (lanes == 2 && random.chance(0.2)) {
    (random.chance(0.5) ? road.lanes_forward : road.lanes_backward) = 1;
  }
}

void draw_median(Random& random, RoadStyle& road) {
  if (road.lanes_backward == 0) return;
  const bool wide = road.lanes_forward + road.lanes_backward >= 4;
  const double draw = random.uniform();
  if (draw < (wide ? 0.45 : 0.85)) return;
  if (draw < (wide ? 0.55 : 0.9)) {
    road.median = MedianKind::kPainted;
    road.median_width_m = random.uniform(0.6, 3.0);
  } else if (draw < (wide ? 0.9 : 0.98)) {
    road.median = MedianKind::kIsland;
    road.median_width_m = random.uniform(1.2, 6.0);
  } else {
    road.median = MedianKind::kBarrier;
    road.median_width_m = random.uniform(1.0, 1.8);
  }
}

void draw_markings(const TownStyle& town, Random& random, RoadStyle& road) {
  road.divider.dash_m = town.dash_m;
  road.divider.gap_m = town.gap_m;
  if (random.chance(0.15)) {
    const DashPattern pattern = kDashPatterns[random.index(kDashPatterns.size())];
    road.divider.dash_m = pattern.dash_m;
    road.divider.gap_m = pattern.gap_m;
  }
  road.divider.width_m = random.uniform(0.1, 0.17);
  road.divider.albedo = white_paint(random);
  road.divider.appearance = random.chance(0.88) ? Appearance::kDashed : Appearance::kSolid;
  road.centre = road.divider;
  if (town.yellow_centre_lines) road.centre.albedo = kCentreYellow;
  const bool single_lanes = road.lanes_forward + road.lanes_backward == 2;
  const double draw = random.uniform() + (single_lanes ? 0.0 : 0.3);
  road.centre.appearance = draw < 0.45   ? Appearance::kDashed
                           : draw < 0.85 ? Appearance::kSolid
                                         : Appearance::kDoubleSolid;
  road.edge_lines = random.chance(0.75 - 0.4 * town.urbanity);
  road.edge_line_width_m = random.uniform(0.1, 0.25);
}

}  // namespace

TownStyle random_town_style(Random& random) {
  TownStyle town;
  town.left_hand_traffic = random.chance(0.2);
  town.yellow_centre_lines = random.chance(0.35);
  town.urbanity = random.uniform();
  town.lane_width_m = random.uniform(2.9, 3.6);
  const DashPattern pattern = kDashPatterns[random.index(kDashPatterns.size())];
  town.dash_m = pattern.dash_m;
  town.gap_m = pattern.gap_m;
  town.wear = random.chance(0.25) ? random.uniform(0.35, 0.7) : random.uniform(0.0, 0.35);
  town.corner_radius_m = random.uniform(4.0, 11.0);
  town.crossing_chance = random.uniform(0.25, 0.95);
  const double crossing = random.uniform();
  town.crossing = crossing < 0.55  ? Appearance::kZebra
                  : crossing < 0.8 ? Appearance::kLadder
                                   : Appearance::kUnknown;
  town.crossing_bar_m = random.uniform(0.35, 0.7);
  town.roundabout_chance = random.uniform(0.0, 0.25);
  town.parking_chance = random.uniform(0.0, 0.4 + 0.4 * town.urbanity);
  town.parking_occupancy = random.uniform(0.1, 0.95);
  town.traffic_density = random.uniform(0.1, 2.0);
  town.kerb = random_kerb(random);
  town.kerb_height_m = random.uniform(0.06, 0.18);
  town.sidewalk = random.chance(0.5)   ? GroundMaterial::kPaving
                  : random.chance(0.5) ? GroundMaterial::kConcrete
                                       : GroundMaterial::kAsphalt;
  const double ground = random.uniform();
  town.background = ground < 0.65   ? GroundMaterial::kGrass
                    : ground < 0.75 ? GroundMaterial::kDirt
                    : ground < 0.85 ? GroundMaterial::kGravel
                                    : GroundMaterial::kPaving;
  town.tree_density = random.uniform();
  town.map_closes_driveways = random.chance(0.4);
  town.map_lists_edge_lines = random.chance(0.12);
  town.map_omission = random.uniform(0.0, 0.04);
  town.map_ghost = random.uniform(0.0, 0.04);
  town.map_shift_m = random.uniform(0.0, 0.04);
  return town;
}

RoadStyle random_road_style(const TownStyle& town, Random& random) {
  RoadStyle road;
  road.lane_width_m = std::clamp(town.lane_width_m + random.normal(0.0, 0.2), 2.75, 3.75);
  draw_lane_counts(town, random, road);
  draw_median(random, road);
  draw_markings(town, random, road);
  road.gutter_m = random.chance(0.3) ? random.uniform(0.5, 1.5) : random.uniform(0.15, 0.5);
  road.material = random.chance(0.88) ? GroundMaterial::kAsphalt : GroundMaterial::kConcrete;
  road.brightness = static_cast<float>(random.uniform(0.7, 1.35));
  road.wear = static_cast<float>(std::clamp(town.wear + random.normal(0.0, 0.12), 0.0, 0.85));
  constexpr std::array kLimits_mps{8.3, 13.9, 13.9, 16.7};
  road.speed_limit_mps = kLimits_mps[random.index(kLimits_mps.size())];
  for (EdgeStyle& edge : road.edges) edge = random_edge(town, random);
  if (random.chance(0.6)) road.edges[1] = road.edges[0];
  return road;
}

}  // namespace bevloc::sim
