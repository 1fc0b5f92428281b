// The style of a town and of its roads: everything that differs between towns besides the plan.
#pragma once

#include "sim/random.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// How a lane divider is painted.
struct DividerPaint {
  Appearance appearance = Appearance::kDashed;
  double width_m = 0.12;
  double dash_m = 3.0;  ///< length of a dash, for dashed lines
  double gap_m = 6.0;
  Rgb albedo{0.8F, 0.8F, 0.8F};
};

/// What lies along the edge of a road.
struct EdgeStyle {
  Appearance boundary = Appearance::kKerb;  ///< kKerb, kRoadEdge, kBarrier, kGuardRail, ...
  WallTexture kerb = WallTexture::kKerbPlain;
  double kerb_height_m = 0.12;
  double verge_m = 0.0;     ///< width of the grass between kerb and sidewalk
  double sidewalk_m = 2.0;  ///< width; 0 without a sidewalk
  double driveways_per_100m = 0.0;
};

enum class MedianKind : uint8_t { kNone, kPainted, kIsland, kBarrier };

struct RoadStyle {
  double lane_width_m = 3.2;
  int lanes_forward = 1;
  int lanes_backward = 1;  ///< 0 on a one-way road
  MedianKind median = MedianKind::kNone;
  double median_width_m = 0.0;
  DividerPaint centre;
  DividerPaint divider;
  bool edge_lines = true;
  double edge_line_width_m = 0.12;
  double gutter_m = 0.3;  ///< distance from the outer lane to the edge of the road
  GroundMaterial material = GroundMaterial::kAsphalt;
  float brightness = 1.0F;
  float wear = 0.2F;
  double speed_limit_mps = 13.9;
  EdgeStyle edges[2];  ///< right of the forward and right of the backward carriageway
};

struct TownStyle {
  bool left_hand_traffic = false;
  bool yellow_centre_lines = false;
  double urbanity = 0.5;  ///< 0 in open country, 1 in the inner city
  double lane_width_m = 3.2;
  double dash_m = 3.0;
  double gap_m = 6.0;
  double wear = 0.25;
  double corner_radius_m = 6.0;
  double crossing_chance = 0.6;  ///< per arm of a junction
  Appearance crossing = Appearance::kZebra;
  double crossing_bar_m = 0.5;
  double roundabout_chance = 0.12;
  double parking_chance = 0.3;
  double parking_occupancy = 0.5;
  double traffic_density = 1.0;
  WallTexture kerb = WallTexture::kKerbPlain;
  double kerb_height_m = 0.12;
  GroundMaterial sidewalk = GroundMaterial::kPaving;
  GroundMaterial background = GroundMaterial::kGrass;
  double tree_density = 0.5;

  // Errors and conventions of the town's HD map.
  bool map_closes_driveways = false;  ///< boundaries have no gaps at driveways
  bool map_lists_edge_lines = false;  ///< the map has painted edge lines as dividers
  double map_omission = 0.015;        ///< chance that an element is missing in the map
  double map_ghost = 0.015;           ///< chance that an element of the map is not on the road
  double map_shift_m = 0.02;          ///< sigma of an element's displacement, per axis
};

TownStyle random_town_style(Random& random);
RoadStyle random_road_style(const TownStyle& town, Random& random);

}  // namespace bevloc::sim
