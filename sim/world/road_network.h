// The town's roads and junctions, before anything is painted or built.
#pragma once

#include <array>
#include <vector>

#include "sim/world/path.h"
#include "sim/world/town_style.h"

namespace bevloc::sim {

/// A stretch of a road.
struct Interval {
  double begin_m = 0.0;
  double end_m = 0.0;
};

/// The lanes of one driving direction. Stations run in driving direction; offsets are metres to
/// the right of the road's reference line.
struct Carriageway {
  Path path;
  double inner_m = 0.0;  ///< offset of the leftmost lane's left bound
  double lane_width_m = 3.2;
  double gutter_m = 0.3;
  int lanes_at_start = 0;
  int lanes_at_end = 0;  ///< differs from the start by one at most, over a taper of the outer lane
  double taper_begin_m = 0.0;
  double taper_end_m = 0.0;
  double parking_m = 0.0;  ///< width of the parking bays between two stations
  double parking_begin_m = 0.0;
  double parking_end_m = 0.0;
  double bay_m = 5.8;          ///< length of a bay along the road; short ones are entered crosswise
  double begin_m = 0.0;        ///< station of the throat of the junction that it leaves
  double end_m = 0.0;          ///< and of the one that it enters
  double paint_begin_m = 0.0;  ///< where the road's markings begin and end, clear of crossings
  double paint_end_m = 0.0;
  Interval crossing;  ///< a pedestrian crossing between the junctions; empty if there is none

  double lane_count(double station_m) const;
  /// Offset of the outer lane's right bound.
  double lanes_edge(double station_m) const;
  double parking_width(double station_m) const;
  /// The stretch where the parking bays have their full width.
  Interval bays() const;
  /// Offset of the road's edge.
  double kerb(double station_m) const;

  bool has_lanes() const { return lanes_at_start > 0; }
  bool has_crossing() const { return crossing.end_m > crossing.begin_m; }
  /// The parts of a stretch that keep clear of the crossing.
  std::vector<Interval> clear_of_crossing(double from_m, double to_m) const;
};

/// sides[0] runs along the reference line, sides[1] against it (no lanes if the road is one-way,
/// but it still has an edge).
struct Road {
  RoadStyle style;
  std::array<Carriageway, 2> sides;
};

/// The end of a road at a junction.
struct Arm {
  size_t road = 0;
  size_t outward_side = 0;   ///< the carriageway that leaves the junction
  double heading_rad = 0.0;  ///< away from the junction
  double throat_m = 0.0;     ///< distance from the road's end to where the junction begins
  double crossing_m = 0.0;   ///< width of the pedestrian crossing, 0 if there is none
  double mouth_m = 0.0;      ///< distance from the road's end to the stop line
};

struct Junction {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  std::vector<Arm> arms;  ///< counter-clockwise
  bool roundabout = false;
  double island_radius_m = 0.0;  ///< of a roundabout
  double outer_radius_m = 0.0;   ///< of its ring
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

/// The part of a roundabout's ring, as angles from its centre, between where traffic from one arm
/// joins and where it leaves for the next.
struct RingSector {
  double begin_rad = 0.0;
  double end_rad = 0.0;   ///< above begin_rad
  bool squeezed = false;  ///< the arms are so close that their corners meet before the ring
};
RingSector ring_sector(const RoadNetwork& network, const Junction& roundabout, size_t arm);

RoadNetwork make_road_network(const TownStyle& town, Random& random);

}  // namespace bevloc::sim
