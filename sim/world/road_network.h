// The roads and junctions of a town as geometry, without paint and buildings.
#pragma once

#include <array>
#include <vector>

#include "sim/world/path.h"
#include "sim/world/town_style.h"

namespace bevloc::sim {

/// A range of stations along a road.
struct Interval {
  double begin_m = 0.0;
  double end_m = 0.0;
};

/// The lanes of one driving direction. Stations increase in driving direction. Offsets are metres
/// to the right of the road's reference line.
struct Carriageway {
  Path path;
  double inner_m = 0.0;  ///< offset of the left bound of the leftmost lane
  double lane_width_m = 3.2;
  double gutter_m = 0.3;
  int lanes_at_start = 0;
  int lanes_at_end = 0;  ///< differs from the start by at most one; the outer lane tapers
  double taper_begin_m = 0.0;
  double taper_end_m = 0.0;
  double parking_m = 0.0;  ///< width of the parking bays; 0 without bays
  double parking_begin_m = 0.0;
  double parking_end_m = 0.0;
  double bay_m = 5.8;          ///< length of a bay along the road; short bays are crosswise
  double begin_m = 0.0;        ///< where the junction behind ends (its throat)
  double end_m = 0.0;          ///< where the junction ahead begins (its throat)
  double paint_begin_m = 0.0;  ///< where the road's markings begin, clear of the crossing
  double paint_end_m = 0.0;    ///< where they end
  Interval crossing;           ///< a pedestrian crossing between the junctions; may be empty

  /// Number of lanes, a fraction within a taper.
  double lane_count(double station_m) const;
  /// Offset of the right bound of the outer lane.
  double lanes_edge(double station_m) const;
  double parking_width(double station_m) const;
  /// Where the parking bays have their full width.
  Interval bays() const;
  /// Offset of the road's edge.
  double kerb(double station_m) const;

  bool has_lanes() const { return lanes_at_start > 0; }
  bool has_crossing() const { return crossing.end_m > crossing.begin_m; }
  /// The parts of [from_m, to_m] that keep a distance to the crossing.
  std::vector<Interval> clear_of_crossing(double from_m, double to_m) const;
};

/// sides[0] runs along the reference line, sides[1] against it. On a one-way road sides[1] has no
/// lanes but still an edge.
struct Road {
  RoadStyle style;
  std::array<Carriageway, 2> sides;
};

/// The end of a road at a junction.
struct Arm {
  size_t road = 0;
  size_t outward_side = 0;   ///< index of the carriageway that leaves the junction
  double heading_rad = 0.0;  ///< direction away from the junction
  double throat_m = 0.0;     ///< distance from the road's end to where the junction begins
  double crossing_m = 0.0;   ///< width of the pedestrian crossing; 0 without one
  double mouth_m = 0.0;      ///< distance from the road's end to the stop line
};

struct Junction {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  std::vector<Arm> arms;  ///< counter-clockwise
  bool roundabout = false;
  double island_radius_m = 0.0;  ///< radius of a roundabout's island
  double outer_radius_m = 0.0;   ///< outer radius of a roundabout's ring
};

struct RoadNetwork {
  std::vector<Road> roads;
  std::vector<Junction> junctions;

  const Carriageway& outward(const Arm& arm) const {
    return roads[arm.road].sides[arm.outward_side];
  }
  const Carriageway& inward(const Arm& arm) const {
    return roads[arm.road].sides[1 - arm.outward_side];
  }
};

/// A part of a roundabout's ring: from the angle where traffic joins from one arm to the angle
/// where it leaves for the next arm.
struct RingSector {
  double begin_rad = 0.0;
  double end_rad = 0.0;   ///< greater than begin_rad
  bool squeezed = false;  ///< the arms are so close that their corners do not reach the ring
};
/// The sector from arm number `arm` to the next one.
RingSector ring_sector(const RoadNetwork& network, const Junction& roundabout, size_t arm);

/// Draws a random road network.
RoadNetwork make_road_network(const TownStyle& town, Random& random);

}  // namespace bevloc::sim
