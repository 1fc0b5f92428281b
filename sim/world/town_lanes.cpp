#include "sim/world/town_lanes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/se2.h"

namespace bevloc::sim {
namespace {

using LaneIds = std::vector<uint32_t>;  ///< ids from the inner to the outer lane

/// The lanes at the beginning and at the end of a carriageway.
struct CarriagewayLanes {
  LaneIds first;
  LaneIds last;
};

constexpr double kTurnSpeed_mps = 7.0;

/// Adds lanes to a map. All roads must be added before the first junction.
class LaneLayer {
 public:
  LaneLayer(const RoadNetwork& network, HdMap& map) : network_(network), map_(map) {}

  void add_road(const Road& road) {
    std::array<CarriagewayLanes, 2>& ends = ends_.emplace_back();
    for (size_t i = 0; i < 2; ++i) {
      if (road.sides[i].has_lanes()) ends[i] = add_carriageway(road.sides[i], road.style);
    }
  }

  void add_junction(const Junction& junction);
  void add_roundabout(const Junction& junction);

 private:
  uint32_t add_lane(const Polyline& centreline, double width_m, double speed_mps);
  LaneIds add_parallel_lanes(const Carriageway& side, double from_m, double to_m, int lanes,
                             double speed_mps);
  CarriagewayLanes add_carriageway(const Carriageway& side, const RoadStyle& style);
  /// Adds a lane from the end of one lane to the start of another.
  void connect(uint32_t from, uint32_t to, double width_m);
  void connect_arms(const Arm& from, const Arm& to, double turn_rad);

  const LaneIds& arriving(const Arm& arm) const {
    return ends_[arm.road][1 - arm.outward_side].last;
  }
  const LaneIds& leaving(const Arm& arm) const { return ends_[arm.road][arm.outward_side].first; }

  const RoadNetwork& network_;
  HdMap& map_;
  std::vector<std::array<CarriagewayLanes, 2>> ends_;  ///< per road
};

uint32_t LaneLayer::add_lane(const Polyline& centreline, double width_m, double speed_mps) {
  const Path path(centreline);
  Lane lane;
  lane.centerline = centreline;
  lane.left = path.parallel(0.0, path.length_m(), -0.5 * width_m);
  lane.right = path.parallel(0.0, path.length_m(), 0.5 * width_m);
  lane.speed_limit_mps = speed_mps;
  map_.lanes.push_back(std::move(lane));
  return static_cast<uint32_t>(map_.lanes.size()) - 1;
}

LaneIds LaneLayer::add_parallel_lanes(const Carriageway& side, double from_m, double to_m,
                                      int lanes, double speed_mps) {
  LaneIds ids;
  for (int k = 0; k < lanes; ++k) {
    const double centre_m = side.inner_m + (k + 0.5) * side.lane_width_m;
    ids.push_back(
        add_lane(side.path.parallel(from_m, to_m, centre_m), side.lane_width_m, speed_mps));
  }
  return ids;
}

CarriagewayLanes LaneLayer::add_carriageway(const Carriageway& side, const RoadStyle& style) {
  const double speed = style.speed_limit_mps;
  if (side.lanes_at_start == side.lanes_at_end) {
    const LaneIds ids =
        add_parallel_lanes(side, side.begin_m, side.end_m, side.lanes_at_start, speed);
    return {ids, ids};
  }
  const int through = std::min(side.lanes_at_start, side.lanes_at_end);
  const LaneIds before =
      add_parallel_lanes(side, side.begin_m, side.taper_begin_m, side.lanes_at_start, speed);
  const LaneIds taper =
      add_parallel_lanes(side, side.taper_begin_m, side.taper_end_m, through, speed);
  const LaneIds after =
      add_parallel_lanes(side, side.taper_end_m, side.end_m, side.lanes_at_end, speed);
  for (size_t k = 0; k < taper.size(); ++k) {
    map_.lanes[before[k]].successors.push_back(taper[k]);
    map_.lanes[taper[k]].successors.push_back(after[k]);
  }
  // The outer lane merges into its neighbour or branches off from it.
  const auto centre_m = [&](double lane) {
    return side.inner_m + (lane + 0.5) * side.lane_width_m;
  };
  const bool merges = before.size() > after.size();
  const double from_m = centre_m(merges ? through : through - 1);
  const double to_m = centre_m(merges ? through - 1 : through);
  const Polyline line =
      side.path.parallel(side.taper_begin_m, side.taper_end_m, [&](double station_m) {
        return from_m +
               (to_m - from_m) * smooth_step(side.taper_begin_m, side.taper_end_m, station_m);
      });
  const uint32_t id = add_lane(line, side.lane_width_m, speed);
  map_.lanes[before.back()].successors.push_back(id);
  map_.lanes[id].successors.push_back(after.back());
  return {before, after};
}

void LaneLayer::connect(uint32_t from, uint32_t to, double width_m) {
  const Polyline& source = map_.lanes[from].centerline;
  const Polyline& target = map_.lanes[to].centerline;
  const Eigen::Vector2d out = (source.back() - source[source.size() - 2]).normalized();
  const Eigen::Vector2d in = (target[1] - target[0]).normalized();
  const uint32_t id =
      add_lane(smooth_turn(source.back(), out, target.front(), in), width_m, kTurnSpeed_mps);
  map_.lanes[from].successors.push_back(id);
  map_.lanes[id].successors.push_back(to);
}

/// Connects the lanes that a driver would use: left turns lead from inner lane to inner lane, right
/// turns from outer to outer, and straight on each lane to its counterpart.
void LaneLayer::connect_arms(const Arm& from, const Arm& to, double turn_rad) {
  constexpr double kStraight_rad = 0.7;
  const LaneIds& in = arriving(from);
  const LaneIds& out = leaving(to);
  const double width_m = network_.inward(from).lane_width_m;
  if (turn_rad > kStraight_rad) {
    connect(in.front(), out.front(), width_m);
  } else if (turn_rad < -kStraight_rad) {
    connect(in.back(), out.back(), width_m);
  } else {
    for (size_t k = 0; k < in.size(); ++k) {
      connect(in[k], out[std::min(k, out.size() - 1)], width_m);
    }
  }
}

void LaneLayer::add_junction(const Junction& junction) {
  for (const Arm& from : junction.arms) {
    const Arm* straightest = nullptr;
    double smallest_turn = 10.0;
    for (const Arm& to : junction.arms) {
      if (arriving(from).empty() || leaving(to).empty() || to.road == from.road) continue;
      const double turn = wrap_angle(to.heading_rad - from.heading_rad - std::numbers::pi);
      connect_arms(from, to, turn);
      if (std::abs(turn) < std::abs(smallest_turn)) {
        smallest_turn = turn;
        straightest = &to;
      }
    }
    for (size_t k = 0; k < arriving(from).size(); ++k) {
      if (!map_.lanes[arriving(from)[k]].successors.empty()) continue;
      const LaneIds& out = leaving(*straightest);
      connect(arriving(from)[k], out[std::min(k, out.size() - 1)],
              network_.inward(from).lane_width_m);
    }
  }
}

/// Cuts the ring into lanes where the traffic of each arm leaves and joins.
void LaneLayer::add_roundabout(const Junction& junction) {
  const double radius = 0.5 * (junction.island_radius_m + junction.outer_radius_m);
  const double width = 0.8 * (junction.outer_radius_m - junction.island_radius_m);
  const size_t arms = junction.arms.size();
  const auto add_arc = [&](double from_rad, double to_rad) {
    const int pieces = std::max(4, static_cast<int>(std::ceil((to_rad - from_rad) * radius / 0.8)));
    Polyline line;
    for (int k = 0; k <= pieces; ++k) {
      const double angle = from_rad + (to_rad - from_rad) * k / pieces;
      line.emplace_back(junction.centre + radius * unit_vector(angle));
    }
    return add_lane(line, width, kTurnSpeed_mps);
  };
  LaneIds between;  // lanes from arm i to arm i + 1
  LaneIds past;     // lanes past arm i + 1
  for (size_t i = 0; i < arms; ++i) {
    const RingSector sector = ring_sector(network_, junction, i);
    const RingSector next = ring_sector(network_, junction, (i + 1) % arms);
    const double turn = next.begin_rad < sector.end_rad ? 2.0 * std::numbers::pi : 0.0;
    between.push_back(add_arc(sector.begin_rad, sector.end_rad));
    past.push_back(add_arc(sector.end_rad, next.begin_rad + turn));
  }
  for (size_t i = 0; i < arms; ++i) {
    const Arm& arm = junction.arms[i];
    const Arm& next = junction.arms[(i + 1) % arms];
    map_.lanes[between[i]].successors.push_back(past[i]);
    map_.lanes[past[i]].successors.push_back(between[(i + 1) % arms]);
    for (const uint32_t id : arriving(arm)) {
      connect(id, between[i], network_.inward(arm).lane_width_m);
    }
    for (const uint32_t id : leaving(next)) {
      connect(between[i], id, network_.outward(next).lane_width_m);
    }
  }
}

}  // namespace

void add_lanes(const RoadNetwork& network, HdMap& map) {
  LaneLayer layer(network, map);
  for (const Road& road : network.roads) layer.add_road(road);
  for (const Junction& junction : network.junctions) {
    if (junction.roundabout) {
      layer.add_roundabout(junction);
    } else {
      layer.add_junction(junction);
    }
  }
}

}  // namespace bevloc::sim
