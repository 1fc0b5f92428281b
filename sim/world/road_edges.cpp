#include "sim/world/road_edges.h"

#include <algorithm>
#include <cmath>

namespace bevloc::sim {
namespace {

/// The area between two lines parallel to a carriageway.
Ring band(const Carriageway& side, double from_m, double to_m,
          const std::function<double(double)>& near_m, const std::function<double(double)>& far_m) {
  Ring ring = side.path.parallel(from_m, to_m, near_m);
  append(ring, reversed(side.path.parallel(from_m, to_m, far_m)));
  return ring;
}

void add_carriageway_surface(const Road& road, WorldBuilder& builder) {
  constexpr double kOverlap_m = 0.3;  // overlap with the surfaces of the junctions
  const Carriageway& forward = road.sides[0];
  const Carriageway& backward = road.sides[1];
  Ring ring = forward.path.parallel(forward.begin_m - kOverlap_m, forward.end_m + kOverlap_m,
                                    [&](double s) { return forward.kerb(s); });
  append(ring, backward.path.parallel(backward.begin_m - kOverlap_m, backward.end_m + kOverlap_m,
                                      [&](double s) { return backward.kerb(s); }));
  builder.add_surface(Layer::kCarriageway, ring, road.style.material, road.style.brightness);
}

std::vector<Interval> driveways(const Carriageway& side, const EdgeStyle& edge, Random& random) {
  std::vector<Interval> gaps;
  if (edge.driveways_per_100m <= 0.0) return gaps;
  double station_m = side.begin_m;
  while (true) {
    station_m += 6.0 - std::log(1.0 - random.uniform()) * 100.0 / edge.driveways_per_100m;
    const double width_m = random.uniform(3.0, 6.5);
    if (station_m + width_m > side.end_m - 5.0) return gaps;
    gaps.push_back({station_m, station_m + width_m});
    station_m += width_m;
  }
}

void add_side_bands(const Carriageway& side, const EdgeStyle& edge, WorldBuilder& builder) {
  const auto kerb = [&](double s) { return side.kerb(s); };
  const auto verge = [&](double s) { return side.kerb(s) + edge.verge_m; };
  if (edge.verge_m > 0.0) {
    builder.add_surface(Layer::kVerge, band(side, side.begin_m, side.end_m, kerb, verge),
                        GroundMaterial::kGrass);
  }
  if (edge.sidewalk_m > 0.0) {
    const auto far = [&](double s) { return side.kerb(s) + edge.verge_m + edge.sidewalk_m; };
    builder.add_surface(Layer::kSidewalk, band(side, side.begin_m, side.end_m, verge, far),
                        builder.town().sidewalk,
                        static_cast<float>(builder.random().uniform(0.8, 1.2)));
  } else if (edge.boundary == Appearance::kRoadEdge && builder.random().chance(0.5)) {
    const double width_m = builder.random().uniform(0.3, 1.5);
    const auto shoulder = [&](double s) { return side.kerb(s) + width_m; };
    builder.add_surface(
        Layer::kVerge, band(side, side.begin_m, side.end_m, kerb, shoulder),
        builder.random().chance(0.5) ? GroundMaterial::kGravel : GroundMaterial::kDirt);
  }
}

void add_driveway_surfaces(const Carriageway& side, const std::vector<Interval>& gaps,
                           WorldBuilder& builder) {
  Random& random = builder.random();
  const GroundMaterial material = random.chance(0.4)   ? GroundMaterial::kAsphalt
                                  : random.chance(0.5) ? GroundMaterial::kPaving
                                                       : GroundMaterial::kGravel;
  for (const Interval& gap : gaps) {
    const double depth_m = random.uniform(5.0, 12.0);
    builder.add_surface(Layer::kDriveway,
                        band(
                            side, gap.begin_m, gap.end_m, [&](double s) { return side.kerb(s); },
                            [&](double s) { return side.kerb(s) + depth_m; }),
                        material, static_cast<float>(random.uniform(0.7, 1.3)));
  }
}

/// The road's edge, interrupted by driveways. The map has the same gaps unless the town's map
/// closes driveways.
void add_boundaries(const Carriageway& side, const EdgeStyle& edge,
                    const std::vector<Interval>& gaps, WorldBuilder& builder) {
  const auto line = [&](double from_m, double to_m) {
    return side.path.parallel(from_m, to_m, [&](double s) { return side.kerb(s); });
  };
  double station_m = side.begin_m;
  for (const Interval& gap : gaps) {
    builder.add_boundary(line(station_m, gap.begin_m), edge);
    if (builder.town().map_closes_driveways) {
      builder.add_map_boundary(line(gap.begin_m, gap.end_m), edge.boundary);
    }
    station_m = gap.end_m;
  }
  builder.add_boundary(line(station_m, side.end_m), edge);
}

/// The closed outline of a median: two straight sides and two round ends.
Ring median_outline(const Carriageway& side, double from_m, double to_m, double half_width_m) {
  Ring ring = side.path.parallel(from_m + half_width_m, to_m - half_width_m, half_width_m);
  const auto round_end = [&](double station_m, double sign) {
    const Eigen::Vector2d centre = side.path.position(station_m);
    const Eigen::Vector2d ahead = sign * side.path.direction(station_m);
    constexpr int kPieces = 8;
    Polyline arc;
    for (int k = 0; k <= kPieces; ++k) {
      const double angle = std::numbers::pi * k / kPieces;
      arc.emplace_back(centre +
                       half_width_m * (std::sin(angle) * ahead - std::cos(angle) * left_of(ahead)));
    }
    return arc;
  };
  append(ring, round_end(to_m - half_width_m, 1.0));
  append(ring, side.path.parallel(to_m - half_width_m, from_m + half_width_m, -half_width_m));
  append(ring, round_end(from_m + half_width_m, -1.0));
  ring.pop_back();  // it repeats the first point
  return ring;
}

void add_island_median(const Road& road, const Interval& stretch, WorldBuilder& builder) {
  Random& random = builder.random();
  const Carriageway& side = road.sides[0];
  // The island keeps a small distance to the lanes.
  const double half_width_m = 0.5 * road.style.median_width_m - 0.15;
  const Ring outline = median_outline(side, stretch.begin_m, stretch.end_m, half_width_m);
  const bool green = half_width_m > 1.2 && random.chance(0.6);
  builder.add_surface(Layer::kIsland, outline,
                      green ? GroundMaterial::kGrass : GroundMaterial::kPaving);
  EdgeStyle edge = road.style.edges[0];
  edge.boundary = Appearance::kKerb;
  Polyline closed = outline;
  closed.push_back(closed.front());
  builder.add_boundary(closed, edge);
  if (half_width_m > 0.7 && random.chance(0.15)) {
    builder.add_wall(side.path.parallel(stretch.begin_m + 3.0, stretch.end_m - 3.0, 0.0),
                     WallTexture::kHedge, 0.0, random.uniform(0.5, 1.2), kHedgeGreen);
  }
}

void add_median(const Road& road, WorldBuilder& builder) {
  const Carriageway& side = road.sides[0];
  const bool island = road.style.median == MedianKind::kIsland;
  if (!island && road.style.median != MedianKind::kBarrier) return;
  EdgeStyle barrier = road.style.edges[0];
  barrier.boundary = builder.random().chance(0.6) ? Appearance::kBarrier : Appearance::kGuardRail;
  for (const Interval& part :
       side.clear_of_crossing(side.paint_begin_m + 0.5, side.paint_end_m - 0.5)) {
    if (part.end_m - part.begin_m < 2.0 * road.style.median_width_m + 4.0) continue;
    if (island) {
      add_island_median(road, part, builder);
    } else {
      builder.add_boundary(side.path.parallel(part.begin_m, part.end_m, 0.0), barrier);
    }
  }
}

/// The kerb line at a corner, from the left edge of one arm to the right edge of the next.
Polyline corner_line(const RoadNetwork& network, const Arm& arm, const Arm& next) {
  const Carriageway& in = network.inward(arm);
  const Carriageway& out = network.outward(next);
  return smooth_turn(in.path.beside(in.end_m, in.kerb(in.end_m)), in.path.direction(in.end_m),
                     out.path.beside(out.begin_m, out.kerb(out.begin_m)),
                     out.path.direction(out.begin_m));
}

/// The corner line at a roundabout. It follows the ring if the arms are far enough apart.
Polyline ring_corner_line(const RoadNetwork& network, const Junction& junction, size_t arm) {
  const Arm& next = junction.arms[(arm + 1) % junction.arms.size()];
  const RingSector sector = ring_sector(network, junction, arm);
  if (sector.squeezed) return corner_line(network, junction.arms[arm], next);
  const Carriageway& in = network.inward(junction.arms[arm]);
  const Carriageway& out = network.outward(next);
  const double radius = junction.outer_radius_m;
  const auto on_ring = [&](double angle_rad) -> Eigen::Vector2d {
    return junction.centre + radius * unit_vector(angle_rad);
  };
  Polyline line =
      smooth_turn(in.path.beside(in.end_m, in.kerb(in.end_m)), in.path.direction(in.end_m),
                  on_ring(sector.begin_rad), left_of(unit_vector(sector.begin_rad)));
  const double span = sector.end_rad - sector.begin_rad;
  const int pieces = std::max(2, static_cast<int>(span * radius));
  for (int k = 1; k < pieces; ++k) line.push_back(on_ring(sector.begin_rad + span * k / pieces));
  append(line, smooth_turn(on_ring(sector.end_rad), left_of(unit_vector(sector.end_rad)),
                           out.path.beside(out.begin_m, out.kerb(out.begin_m)),
                           out.path.direction(out.begin_m)));
  return line;
}

/// The edge style of the corner between two arms: a kerb or a road edge, because anything taller
/// would hide the junction.
EdgeStyle corner_style(const RoadNetwork& network, const Arm& arm, const Arm& next) {
  EdgeStyle edge = network.roads[arm.road].style.edges[1 - arm.outward_side];
  const EdgeStyle& other = network.roads[next.road].style.edges[next.outward_side];
  const bool grass =
      edge.boundary == Appearance::kRoadEdge && other.boundary == Appearance::kRoadEdge;
  edge.boundary = grass ? Appearance::kRoadEdge : Appearance::kKerb;
  edge.sidewalk_m = std::min(edge.verge_m + edge.sidewalk_m, other.verge_m + other.sidewalk_m);
  edge.verge_m = 0.0;
  return edge;
}

void add_corner(const Polyline& line, const EdgeStyle& edge, WorldBuilder& builder) {
  builder.add_boundary(line, edge);
  if (edge.sidewalk_m <= 0.0) return;
  const Path path(line);
  Ring ring = line;
  append(ring, reversed(path.parallel(0.0, path.length_m(), edge.sidewalk_m)));
  builder.add_surface(Layer::kSidewalk, ring, builder.town().sidewalk);
}

void add_island(const Junction& junction, WorldBuilder& builder) {
  Random& random = builder.random();
  const double radius = junction.island_radius_m;
  const int pieces = static_cast<int>(std::ceil(2.0 * std::numbers::pi * radius / 0.9));
  Ring ring;
  for (int k = 0; k < pieces; ++k) {
    ring.emplace_back(junction.centre + radius * unit_vector(2.0 * std::numbers::pi * k / pieces));
  }
  builder.add_surface(Layer::kIsland, ring,
                      random.chance(0.7) ? GroundMaterial::kGrass : GroundMaterial::kPaving);
  EdgeStyle edge;
  edge.kerb = builder.town().kerb;
  edge.kerb_height_m = builder.town().kerb_height_m;
  ring.push_back(ring.front());
  builder.add_boundary(ring, edge);
}

}  // namespace

void add_road_edges(const RoadNetwork& network, WorldBuilder& builder) {
  for (const Road& road : network.roads) {
    add_carriageway_surface(road, builder);
    add_median(road, builder);
    for (size_t i = 0; i < 2; ++i) {
      const Carriageway& side = road.sides[i];
      const EdgeStyle& edge = road.style.edges[i];
      const std::vector<Interval> gaps = driveways(side, edge, builder.random());
      add_side_bands(side, edge, builder);
      add_driveway_surfaces(side, gaps, builder);
      add_boundaries(side, edge, gaps, builder);
    }
  }
}

void add_junction_edges(const RoadNetwork& network, WorldBuilder& builder) {
  for (const Junction& junction : network.junctions) {
    Ring ring;
    for (size_t i = 0; i < junction.arms.size(); ++i) {
      const Arm& arm = junction.arms[i];
      const Arm& next = junction.arms[(i + 1) % junction.arms.size()];
      const Polyline line = junction.roundabout ? ring_corner_line(network, junction, i)
                                                : corner_line(network, arm, next);
      append(ring, line);
      add_corner(line, corner_style(network, arm, next), builder);
    }
    const RoadStyle& style = network.roads[junction.arms.front().road].style;
    builder.add_surface(Layer::kCarriageway, ring, style.material, style.brightness);
    if (junction.roundabout) add_island(junction, builder);
  }
}

}  // namespace bevloc::sim
