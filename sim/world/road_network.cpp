#include "sim/world/road_network.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/se2.h"
#include "sim/world/street_grid.h"

namespace bevloc::sim {
namespace {

constexpr double kShortestRoad_m = 22.0;  ///< length from throat to throat

/// A carriageway with a constant number of lanes.
Carriageway plain_carriageway(const Path& path, const RoadStyle& style, int lanes, double inner_m) {
  Carriageway side;
  side.path = path;
  side.inner_m = inner_m;
  side.lane_width_m = style.lane_width_m;
  side.gutter_m = style.gutter_m;
  side.lanes_at_start = lanes;
  side.lanes_at_end = lanes;
  side.end_m = path.length_m();
  return side;
}

/// Sets the road's cross-section from its style, along the given reference line.
void set_cross_section(Road& road, const Path& reference) {
  const RoadStyle& style = road.style;
  double forward_inner = 0.5 * style.median_width_m;
  double backward_inner = forward_inner;
  if (style.lanes_backward == 0) {
    backward_inner = 0.5 * style.lanes_forward * style.lane_width_m;
    forward_inner = -backward_inner;
  }
  road.sides[0] = plain_carriageway(reference, style, style.lanes_forward, forward_inner);
  road.sides[1] =
      plain_carriageway(reference.reversed(), style, style.lanes_backward, backward_inner);
}

/// The first arm of the junction from which no other road can be entered; null if there is none.
const Arm* trapped_arm(const RoadNetwork& network, const Junction& junction) {
  for (const Arm& arm : junction.arms) {
    if (!network.inward(arm).has_lanes()) continue;
    const auto leads_out = [&](const Arm& other) {
      return other.road != arm.road && network.outward(other).has_lanes();
    };
    if (std::none_of(junction.arms.begin(), junction.arms.end(), leads_out)) return &arm;
  }
  return nullptr;
}

/// Makes one-way roads two-way until a vehicle can leave every junction that it can reach.
void open_traps(RoadNetwork& network) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (const Junction& junction : network.junctions) {
      if (trapped_arm(network, junction) == nullptr) continue;
      for (const Arm& arm : junction.arms) {
        Road& road = network.roads[arm.road];
        if (road.style.lanes_backward > 0) continue;
        road.style.lanes_backward = 1;
        const Path reference = road.sides[0].path;
        set_cross_section(road, reference);
        changed = true;
      }
    }
  }
}

/// Some carriageways gain a turning lane before their junction, some lose a lane behind it.
void vary_lane_count(Carriageway& side, Random& random) {
  const bool gains = random.chance(0.15);
  const bool loses = random.chance(0.12);
  if (side.lanes_at_start == 0 || side.path.length_m() < 110.0) return;
  if (gains && side.lanes_at_end < 3) {
    ++side.lanes_at_end;
  } else if (loses && side.lanes_at_start < 3) {
    ++side.lanes_at_start;
  }
}

void narrow(Road& road) {
  RoadStyle& style = road.style;
  style.lanes_forward = 1;
  style.lanes_backward = std::min(style.lanes_backward, 1);
  style.median = MedianKind::kNone;
  style.median_width_m = 0.0;
  style.gutter_m = std::min(style.gutter_m, 0.4);
  style.lane_width_m = std::min(style.lane_width_m, 3.3);
  const Path reference = road.sides[0].path;
  set_cross_section(road, reference);
}

double right_half_width(const RoadNetwork& network, const Arm& arm) {
  return network.outward(arm).kerb(0.0);
}

double left_half_width(const RoadNetwork& network, const Arm& arm) {
  const Carriageway& side = network.inward(arm);
  return side.kerb(side.path.length_m());
}

/// The distance from the junction's centre at which the kerb of an arm must begin to bend towards
/// its neighbour. `near_m` is the half width of the arm, `far_m` that of the neighbour, `gap_rad`
/// the angle between them.
double corner_distance(double near_m, double far_m, double gap_rad, double radius_m) {
  constexpr double kAlmostStraight_rad = 2.4;
  if (gap_rad > kAlmostStraight_rad) return 2.0 + 1.5 * std::abs(near_m - far_m);
  const double meeting = (near_m * std::cos(gap_rad) + far_m) / std::sin(gap_rad);
  return meeting + std::min(radius_m / std::tan(0.5 * gap_rad), radius_m + 3.0);
}

/// The angle from an arm to the next one, counter-clockwise.
double gap_after(const Junction& junction, size_t arm) {
  const size_t next = (arm + 1) % junction.arms.size();
  const double gap = junction.arms[next].heading_rad - junction.arms[arm].heading_rad;
  return gap > 0.0 ? gap : gap + 2.0 * std::numbers::pi;
}

void set_throats(const RoadNetwork& network, const TownStyle& town, Junction& junction) {
  for (Arm& arm : junction.arms) {
    arm.throat_m = junction.roundabout ? junction.outer_radius_m + town.corner_radius_m : 3.0;
  }
  for (size_t i = 0; i < junction.arms.size(); ++i) {
    Arm& arm = junction.arms[i];
    Arm& next = junction.arms[(i + 1) % junction.arms.size()];
    const double gap = gap_after(junction, i);
    const double left = left_half_width(network, arm);
    const double right = right_half_width(network, next);
    arm.throat_m = std::max(arm.throat_m, corner_distance(left, right, gap, town.corner_radius_m));
    next.throat_m =
        std::max(next.throat_m, corner_distance(right, left, gap, town.corner_radius_m));
  }
}

/// Makes some junctions roundabouts, if their arms are far enough apart and not too wide.
void maybe_make_roundabout(const RoadNetwork& network, const TownStyle& town, Random& random,
                           Junction& junction) {
  const bool wanted = random.chance(town.roundabout_chance);
  const double island = random.uniform(5.0, 13.0);
  const double ring = random.uniform(5.0, 7.5);
  double widest = 0.0;
  double smallest_gap = 10.0;
  for (size_t i = 0; i < junction.arms.size(); ++i) {
    widest = std::max({widest, right_half_width(network, junction.arms[i]),
                       left_half_width(network, junction.arms[i])});
    smallest_gap = std::min(smallest_gap, gap_after(junction, i));
  }
  if (!wanted || widest > 9.0 || smallest_gap < 1.1) return;
  junction.roundabout = true;
  junction.island_radius_m = std::max(island, 1.3 * widest);
  junction.outer_radius_m = junction.island_radius_m + ring;
}

/// Narrows roads, in up to six attempts, so that each keeps kShortestRoad_m between its junctions.
void fit_throats(const TownStyle& town, RoadNetwork& network) {
  for (int attempt = 0; attempt < 6; ++attempt) {
    std::vector<double> taken_m(network.roads.size(), 0.0);
    for (Junction& junction : network.junctions) {
      set_throats(network, town, junction);
      for (const Arm& arm : junction.arms) taken_m[arm.road] += arm.throat_m;
    }
    std::vector<bool> short_road(network.roads.size());
    bool fits = true;
    for (size_t i = 0; i < network.roads.size(); ++i) {
      short_road[i] = network.roads[i].sides[0].path.length_m() - taken_m[i] < kShortestRoad_m;
      fits = fits && !short_road[i];
    }
    if (fits) return;
    for (Junction& junction : network.junctions) {
      const auto is_short = [&](const Arm& arm) { return short_road[arm.road]; };
      if (std::none_of(junction.arms.begin(), junction.arms.end(), is_short)) continue;
      junction.roundabout = false;
      for (const Arm& arm : junction.arms) narrow(network.roads[arm.road]);
    }
  }
}

void set_mouths(const TownStyle& town, Random& random, RoadNetwork& network) {
  for (Junction& junction : network.junctions) {
    for (Arm& arm : junction.arms) {
      const bool crossing = random.chance(town.crossing_chance);
      const double width = random.uniform(2.4, 5.0);
      const double set_back = random.uniform(0.6, 1.8);
      Road& road = network.roads[arm.road];
      // A crossing is longer than wide, even on narrow roads.
      const double road_m = left_half_width(network, arm) + right_half_width(network, arm);
      arm.crossing_m = crossing ? std::min(width, 0.7 * road_m) : 0.0;
      arm.mouth_m = arm.throat_m + (crossing ? 0.5 + arm.crossing_m + set_back : 0.3);
      Carriageway& out = road.sides[arm.outward_side];
      Carriageway& in = road.sides[1 - arm.outward_side];
      out.begin_m = arm.throat_m;
      out.paint_begin_m = arm.mouth_m;
      in.end_m = in.path.length_m() - arm.throat_m;
      in.paint_end_m = in.path.length_m() - arm.mouth_m;
    }
  }
}

void set_tapers(Carriageway& side, Random& random) {
  const double fraction = random.uniform(0.35, 0.65);
  const double taper_m = random.uniform(20.0, 45.0);
  const double room_m = side.end_m - side.begin_m;
  const double length_m = std::min(taper_m, 0.4 * room_m);
  side.taper_begin_m = side.begin_m + fraction * room_m - 0.5 * length_m;
  side.taper_end_m = side.taper_begin_m + length_m;
}

void set_parking(const TownStyle& town, Random& random, Carriageway& side) {
  const bool wanted = random.chance(town.parking_chance);
  const bool crosswise = random.chance(0.15);
  const double width_m = crosswise ? random.uniform(4.6, 5.4) : random.uniform(1.9, 2.5);
  const double begin_m = side.begin_m + random.uniform(8.0, 20.0);
  const double end_m = side.end_m - random.uniform(12.0, 24.0);
  if (!wanted || end_m - begin_m < 4.0 * width_m + 12.0) return;
  side.parking_m = width_m;
  side.bay_m = crosswise ? random.uniform(2.3, 2.6) : random.uniform(5.2, 6.2);
  side.parking_begin_m = begin_m;
  side.parking_end_m = end_m;
}

/// Gives some roads a crossing between their junctions, away from bays and tapers.
void set_crossing(const TownStyle& town, Random& random, Road& road) {
  const bool wanted = random.chance(0.35 * town.crossing_chance);
  const double width_m = random.uniform(2.5, 4.5);
  Carriageway& forward = road.sides[0];
  Carriageway& backward = road.sides[1];
  const double begin_m = forward.paint_begin_m +
                         random.uniform(0.2, 0.8) * (forward.paint_end_m - forward.paint_begin_m);
  const double length_m = forward.path.length_m();
  const auto is_free = [](const Carriageway& side, const Interval& at) {
    const bool tapers = side.lanes_at_start != side.lanes_at_end && at.end_m > side.taper_begin_m &&
                        at.begin_m < side.taper_end_m;
    return !tapers && side.parking_width(at.begin_m) == 0.0 &&
           side.parking_width(at.end_m) == 0.0 && at.begin_m > side.paint_begin_m + 15.0 &&
           at.end_m < side.paint_end_m - 15.0;
  };
  const Interval on_forward{begin_m, begin_m + width_m};
  const Interval on_backward{length_m - begin_m - width_m, length_m - begin_m};
  const bool narrow_road = forward.kerb(begin_m) + backward.kerb(length_m - begin_m) < 5.0;
  if (!wanted || narrow_road || !is_free(forward, on_forward)) return;
  if (road.style.lanes_backward > 0 && !is_free(backward, on_backward)) return;
  forward.crossing = on_forward;
  backward.crossing = on_backward;
}

}  // namespace

std::vector<Interval> Carriageway::clear_of_crossing(double from_m, double to_m) const {
  constexpr double kClearance_m = 1.2;
  if (!has_crossing()) return {{from_m, to_m}};
  std::vector<Interval> parts;
  const double before_m = std::min(to_m, crossing.begin_m - kClearance_m);
  const double after_m = std::max(from_m, crossing.end_m + kClearance_m);
  if (before_m > from_m) parts.push_back({from_m, before_m});
  if (to_m > after_m) parts.push_back({after_m, to_m});
  return parts;
}

double Carriageway::lane_count(double station_m) const {
  if (lanes_at_start == lanes_at_end) return lanes_at_start;
  return lanes_at_start +
         (lanes_at_end - lanes_at_start) * smooth_step(taper_begin_m, taper_end_m, station_m);
}

double Carriageway::lanes_edge(double station_m) const {
  return inner_m + lane_count(station_m) * lane_width_m;
}

double Carriageway::parking_width(double station_m) const {
  if (parking_m == 0.0) return 0.0;
  const Interval full = bays();
  return parking_m * smooth_step(parking_begin_m, full.begin_m, station_m) *
         (1.0 - smooth_step(full.end_m, parking_end_m, station_m));
}

Interval Carriageway::bays() const {
  const double taper_m = 2.0 * parking_m;
  return {parking_begin_m + taper_m, parking_end_m - taper_m};
}

double Carriageway::kerb(double station_m) const {
  return lanes_edge(station_m) + parking_width(station_m) + gutter_m;
}

RingSector ring_sector(const RoadNetwork& network, const Junction& roundabout, size_t arm) {
  constexpr double kFlare_m = 4.0;
  constexpr double kShortest_rad = 0.12;
  const auto reach = [&](double half_width_m) {
    return std::asin(std::min(0.92, (half_width_m + kFlare_m) / roundabout.outer_radius_m));
  };
  const Arm& next = roundabout.arms[(arm + 1) % roundabout.arms.size()];
  const double gap = gap_after(roundabout, arm);
  const double joining = reach(left_half_width(network, roundabout.arms[arm]));
  const double leaving = reach(right_half_width(network, next));
  const double scale = std::min(1.0, (gap - kShortest_rad) / (joining + leaving));
  const double heading = roundabout.arms[arm].heading_rad;
  return {heading + scale * joining, heading + gap - scale * leaving, scale < 1.0};
}

RoadNetwork make_road_network(const TownStyle& town, Random& random) {
  const StreetGrid grid = make_street_grid(random);
  RoadNetwork network;
  network.junctions.resize(grid.junctions.size());
  for (size_t i = 0; i < grid.junctions.size(); ++i) {
    network.junctions[i].centre = grid.junctions[i];
  }
  for (const Street& street : grid.streets) {
    Road road;
    road.style = random_road_style(town, random);
    set_cross_section(road, Path(street.line));
    const size_t index = network.roads.size();
    const double length_m = road.sides[0].path.length_m();
    const double heading = road.sides[0].path.heading_rad(0.0);
    const double back_heading = road.sides[0].path.heading_rad(length_m) + std::numbers::pi;
    network.junctions[street.from].arms.push_back(
        {.road = index, .outward_side = 0, .heading_rad = wrap_angle(heading)});
    network.junctions[street.to].arms.push_back(
        {.road = index, .outward_side = 1, .heading_rad = wrap_angle(back_heading)});
    network.roads.push_back(std::move(road));
  }
  open_traps(network);
  for (Road& road : network.roads) {
    for (Carriageway& side : road.sides) vary_lane_count(side, random);
  }
  for (Junction& junction : network.junctions) {
    std::sort(junction.arms.begin(), junction.arms.end(),
              [](const Arm& a, const Arm& b) { return a.heading_rad < b.heading_rad; });
    maybe_make_roundabout(network, town, random, junction);
  }
  fit_throats(town, network);
  set_mouths(town, random, network);
  for (Road& road : network.roads) {
    for (size_t i = 0; i < 2; ++i) {
      set_tapers(road.sides[i], random);
      if (road.style.edges[i].boundary == Appearance::kKerb) {
        set_parking(town, random, road.sides[i]);
      }
    }
    set_crossing(town, random, road);
  }
  return network;
}

}  // namespace bevloc::sim
