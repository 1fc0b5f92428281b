#include "sim/world/road_markings.h"

#include <algorithm>
#include <cmath>

namespace bevloc::sim {
namespace {

constexpr Rgb kTar{0.035F, 0.035F, 0.035F};

/// Moves a shape to a place on the road. The shape's frame: x along the road, y to the left, origin
/// `right_m` to the right of the reference line at `station_m`.
Ring placed(const Ring& shape, const Carriageway& side, double station_m, double right_m) {
  const Eigen::Vector2d origin = side.path.beside(station_m, right_m);
  const Eigen::Vector2d forward = side.path.direction(station_m);
  Ring ring;
  for (const Eigen::Vector2d& p : shape) {
    ring.emplace_back(origin + p.x() * forward + p.y() * left_of(forward));
  }
  return ring;
}

Ring straight_arrow() {
  return {{0.0, 0.08}, {0.0, -0.08}, {2.8, -0.08}, {2.8, -0.4},
          {5.0, 0.0},  {2.8, 0.4},   {2.8, 0.08}};
}

Ring turn_arrow(bool left) {
  Ring ring{{0.0, 0.08}, {0.0, -0.08}, {3.0, -0.08}, {3.6, 0.35}, {3.9, 0.35},
            {3.3, 1.15}, {2.5, 0.35},  {3.0, 0.35},  {2.7, 0.08}};
  if (!left) {
    for (Eigen::Vector2d& p : ring) p.y() = -p.y();
  }
  return ring;
}

class RoadPainter {
 public:
  RoadPainter(const Road& road, WorldBuilder& builder)
      : road_(road), style_(road.style), builder_(builder), random_(builder.random()) {}

  void paint() {
    paint_centre();
    for (const Carriageway& side : road_.sides) {
      if (!side.has_lanes()) continue;
      paint_dividers(side);
      paint_edge_lines(side);
      paint_stop(side, side.paint_end_m);
      if (side.has_crossing()) paint_stop(side, side.crossing.begin_m - 1.2);
      paint_arrows(side);
      paint_word(side);
      paint_bays(side);
    }
    lay_tar();
  }

 private:
  /// Paints a divider, interrupted by the road's crossing. The last `solid_approach_m` before the
  /// junction are solid.
  void divider(const Carriageway& side, double from_m, double to_m, double right_m,
               const DividerPaint& paint, double solid_approach_m);
  /// Paints one uninterrupted part of a divider; its last `solid_approach_m` are solid.
  void stretch(const Carriageway& side, const Interval& part, double right_m,
               const DividerPaint& paint, double solid_approach_m);
  void paint_centre();
  void paint_median_area(double from_m, double to_m);
  void paint_dividers(const Carriageway& side);
  void paint_edge_lines(const Carriageway& side);
  void paint_stop(const Carriageway& side, double station_m);
  void paint_arrows(const Carriageway& side);
  void paint_word(const Carriageway& side);
  void paint_bays(const Carriageway& side);
  void lay_tar();

  const Road& road_;
  const RoadStyle& style_;
  WorldBuilder& builder_;
  Random& random_;
};

void RoadPainter::divider(const Carriageway& side, double from_m, double to_m, double right_m,
                          const DividerPaint& paint, double solid_approach_m) {
  for (const Interval& part : side.clear_of_crossing(from_m, to_m)) {
    if (part.end_m - part.begin_m < 3.0) continue;
    stretch(side, part, right_m, paint, part.end_m == to_m ? solid_approach_m : 0.0);
  }
}

void RoadPainter::stretch(const Carriageway& side, const Interval& part, double right_m,
                          const DividerPaint& paint, double solid_approach_m) {
  const double from_m = part.begin_m;
  const double to_m = part.end_m;
  double split_m = to_m;
  if (paint.appearance == Appearance::kDashed && to_m - from_m > solid_approach_m + 10.0) {
    split_m -= solid_approach_m;
  }
  builder_.add_divider(side.path.parallel(from_m, split_m, right_m), paint, style_.wear);
  if (split_m == to_m) return;
  DividerPaint solid = paint;
  solid.appearance = Appearance::kSolid;
  builder_.add_divider(side.path.parallel(split_m, to_m, right_m), solid, style_.wear);
}

void RoadPainter::paint_centre() {
  const Carriageway& side = road_.sides[0];
  if (!road_.sides[1].has_lanes()) return;
  const double from_m = side.paint_begin_m;
  const double to_m = side.paint_end_m;
  if (to_m - from_m < 4.0) return;
  if (style_.median == MedianKind::kNone) {
    const bool unmarked = style_.lanes_forward + style_.lanes_backward == 2 && random_.chance(0.08);
    if (unmarked) return;
    const double approach_m = random_.chance(0.5) ? random_.uniform(10.0, 30.0) : 0.0;
    divider(side, from_m, to_m, 0.0, style_.centre, approach_m);
  } else if (style_.median == MedianKind::kPainted) {
    DividerPaint solid = style_.centre;
    solid.appearance = Appearance::kSolid;
    for (const double sign : {-1.0, 1.0}) {
      divider(side, from_m, to_m, sign * 0.5 * style_.median_width_m, solid, 0.0);
    }
    if (style_.median_width_m > 1.2 && random_.chance(0.6)) paint_median_area(from_m, to_m);
  }
}

/// Paints slanted bars between the two lines of a painted median.
void RoadPainter::paint_median_area(double from_m, double to_m) {
  const double spacing_m = random_.uniform(1.5, 4.0);
  const double half = 0.5 * style_.median_width_m - 0.15;
  for (double s = from_m + spacing_m; s < to_m - spacing_m; s += spacing_m) {
    if (road_.sides[0].clear_of_crossing(s - 1.5, s + 1.5).size() != 1) continue;
    const Ring bar{{-half, half}, {-half + 0.5, half}, {half + 0.5, -half}, {half, -half}};
    builder_.add_paint_area(placed(bar, road_.sides[0], s, 0.0), style_.centre.albedo, style_.wear);
  }
}

void RoadPainter::paint_dividers(const Carriageway& side) {
  const double approach_m = random_.chance(0.6) ? random_.uniform(12.0, 35.0) : 0.0;
  const int through = std::min(side.lanes_at_start, side.lanes_at_end);
  for (int k = 1; k < through; ++k) {
    divider(side, side.paint_begin_m, side.paint_end_m, side.inner_m + k * side.lane_width_m,
            style_.divider, approach_m);
  }
  const double outer_m = side.inner_m + through * side.lane_width_m;
  if (side.lanes_at_start > through) {
    divider(side, side.paint_begin_m, side.taper_begin_m, outer_m, style_.divider, 0.0);
  } else if (side.lanes_at_end > through) {
    divider(side, side.taper_end_m, side.paint_end_m, outer_m, style_.divider, approach_m);
  }
}

void RoadPainter::paint_edge_lines(const Carriageway& side) {
  if (!style_.edge_lines || side.paint_end_m - side.paint_begin_m < 4.0) return;
  const auto line = [&](const Polyline& points, const Rgb& albedo) {
    builder_.add_edge_line(points, style_.edge_line_width_m, albedo, style_.wear);
  };
  const double inset_m = 0.5 * style_.edge_line_width_m;
  const bool open_inside = !road_.sides[1].has_lanes() || style_.median == MedianKind::kIsland ||
                           style_.median == MedianKind::kBarrier;
  for (const Interval& part : side.clear_of_crossing(side.paint_begin_m, side.paint_end_m)) {
    line(side.path.parallel(part.begin_m, part.end_m,
                            [&](double s) { return side.lanes_edge(s) - inset_m; }),
         kWhitePaint);
    if (!open_inside) continue;
    line(side.path.parallel(part.begin_m, part.end_m, side.inner_m + inset_m),
         builder_.town().yellow_centre_lines ? style_.centre.albedo : kWhitePaint);
  }
}

/// Paints a stop line or give-way teeth before a junction or crossing.
void RoadPainter::paint_stop(const Carriageway& side, double station_m) {
  const double left_m = side.inner_m + 0.1;
  const double right_m = side.lanes_edge(station_m) - 0.1;
  const double draw = random_.uniform();
  const double depth_m = random_.uniform(0.25, 0.6);
  if (draw < 0.65) {
    builder_.add_paint_area(
        {side.path.beside(station_m, left_m), side.path.beside(station_m, right_m),
         side.path.beside(station_m + depth_m, right_m),
         side.path.beside(station_m + depth_m, left_m)},
        kWhitePaint, style_.wear);
  } else if (draw < 0.8) {
    const Ring tooth{{0.0, 0.25}, {0.0, -0.25}, {0.6, 0.0}};
    for (double r = left_m + 0.3; r < right_m - 0.2; r += 0.7) {
      builder_.add_paint_area(placed(tooth, side, station_m - 0.3, r), kWhitePaint, style_.wear);
    }
  }
}

void RoadPainter::paint_arrows(const Carriageway& side) {
  const bool wanted = random_.chance(side.lanes_at_end > 1 ? 0.7 : 0.12);
  const double first_m = random_.uniform(8.0, 14.0);
  if (!wanted) return;
  for (int k = 0; k < side.lanes_at_end; ++k) {
    const bool innermost = k == 0 && random_.chance(0.6);
    const bool outermost = k + 1 == side.lanes_at_end && random_.chance(0.6);
    const Ring arrow = innermost   ? turn_arrow(true)
                       : outermost ? turn_arrow(false)
                                   : straight_arrow();
    for (const double back_m : {first_m, first_m + 20.0}) {
      const double station_m = side.paint_end_m - back_m;
      if (station_m < std::max(side.taper_end_m, side.paint_begin_m)) break;
      const double centre_m = side.inner_m + (k + 0.5) * side.lane_width_m;
      builder_.add_paint_area(placed(arrow, side, station_m, centre_m), kWhitePaint, style_.wear);
    }
  }
}

/// Paints strokes that look like letters (BUS, SLOW) or a speed limit.
void RoadPainter::paint_word(const Carriageway& side) {
  const bool wanted = random_.chance(0.12);
  const double station_m = random_.uniform(side.paint_begin_m + 5.0, side.paint_end_m - 15.0);
  if (!wanted || station_m < side.paint_begin_m || side.has_crossing()) return;
  const double height_m = random_.uniform(1.4, 3.0);
  const int letters = random_.integer(2, 4);
  for (int i = 0; i < letters; ++i) {
    const double centre_m =
        side.inner_m + 0.5 * side.lane_width_m + 0.6 * (i - 0.5 * (letters - 1));
    const auto stroke = [&](double x0, double x1, double y0, double y1) {
      const Ring ring{{x0, y0}, {x0, y1}, {x1, y1}, {x1, y0}};
      builder_.add_paint_area(placed(ring, side, station_m, centre_m), kWhitePaint, style_.wear);
    };
    stroke(0.0, height_m, 0.1, 0.22);
    if (random_.chance(0.6)) stroke(0.0, height_m, -0.22, -0.1);
    if (random_.chance(0.7)) stroke(0.0, 0.25, -0.22, 0.22);
    if (random_.chance(0.7)) stroke(height_m - 0.25, height_m, -0.22, 0.22);
  }
}

/// Marks parking bays with a line along them or with a stroke between neighbouring bays.
void RoadPainter::paint_bays(const Carriageway& side) {
  const double draw = random_.uniform();
  if (side.parking_m == 0.0 || draw < 0.35) return;
  const auto [from_m, to_m] = side.bays();
  if (draw < 0.6) {
    builder_.world().paint_lines.push_back(
        {.points = side.path.parallel(from_m, to_m, [&](double s) { return side.lanes_edge(s); }),
         .width_m = 0.1,
         .dash_m = draw < 0.45 ? 1.0 : 0.0,
         .gap_m = 1.0,
         .albedo = kWhitePaint,
         .wear = style_.wear});
    return;
  }
  for (double s = from_m; s < to_m; s += side.bay_m) {
    const Ring stroke{{0.0, 0.0}, {0.0, -side.parking_m}, {0.1, -side.parking_m}, {0.1, 0.0}};
    builder_.add_paint_area(placed(stroke, side, s, side.lanes_edge(s)), kWhitePaint, style_.wear);
  }
}

/// Adds tar joints, asphalt patches and manhole covers, which a network may mistake for paint.
void RoadPainter::lay_tar() {
  const Carriageway& side = road_.sides[0];
  const double length_m = side.end_m - side.begin_m;
  const double left_m = -road_.sides[1].kerb(0.5 * length_m);
  const double right_m = side.kerb(side.begin_m + 0.5 * length_m);
  const int joints = random_.integer(0, 4) - 1;
  for (int i = 0; i < joints; ++i) {
    const double from_m = side.begin_m + random_.uniform(0.0, 0.7) * length_m;
    const double to_m = std::min(side.end_m, from_m + random_.uniform(8.0, 60.0));
    const double offset_m = random_.uniform(left_m + 0.5, right_m - 0.5);
    builder_.world().paint_lines.push_back({.points = side.path.parallel(from_m, to_m, offset_m),
                                            .width_m = random_.uniform(0.04, 0.12),
                                            .albedo = kTar,
                                            .wear = 0.3F});
  }
  const int patches = random_.integer(0, 5);
  for (int i = 0; i < patches; ++i) {
    const double from_m = side.begin_m + random_.uniform(0.05, 0.9) * length_m;
    const double to_m = std::min(side.end_m, from_m + random_.uniform(1.0, 12.0));
    const double a_m = random_.uniform(left_m + 0.3, right_m - 1.2);
    const double b_m = std::min(right_m, a_m + random_.uniform(0.8, 3.0));
    Ring ring = side.path.parallel(from_m, to_m, a_m);
    append(ring, reversed(side.path.parallel(from_m, to_m, b_m)));
    builder_.add_surface(Layer::kPatch, ring, GroundMaterial::kAsphalt,
                         static_cast<float>(random_.uniform(0.5, 1.4)));
  }
  const int covers = random_.integer(0, 3);
  for (int i = 0; i < covers; ++i) {
    Ring disc;
    for (int k = 0; k < 8; ++k) disc.emplace_back(0.33 * unit_vector(k * std::numbers::pi / 4.0));
    const double station_m = side.begin_m + random_.uniform() * length_m;
    builder_.add_paint_area(
        placed(disc, side, station_m, random_.uniform(left_m + 0.5, right_m - 0.5)), kTar, 0.2F);
  }
}

}  // namespace

void add_road_markings(const RoadNetwork& network, WorldBuilder& builder) {
  for (const Road& road : network.roads) RoadPainter(road, builder).paint();
}

void add_crossings(const RoadNetwork& network, WorldBuilder& builder) {
  const auto add = [&](const Arm& arm, const Interval& at) {
    const Carriageway& out = network.outward(arm);
    const Carriageway& in = network.inward(arm);
    const double right_m = out.kerb(at.begin_m) - 0.15;
    const double left_m = in.kerb(in.path.length_m() - at.begin_m) - 0.15;
    builder.add_crossing(
        {out.path.beside(at.begin_m, -left_m), out.path.beside(at.begin_m, right_m),
         out.path.beside(at.end_m, right_m), out.path.beside(at.end_m, -left_m)},
        builder.town().crossing, network.roads[arm.road].style.wear);
  };
  for (const Junction& junction : network.junctions) {
    for (const Arm& arm : junction.arms) {
      const double begin_m = arm.throat_m + 0.5;
      if (arm.crossing_m > 0.0) add(arm, {begin_m, begin_m + arm.crossing_m});
    }
  }
  for (size_t i = 0; i < network.roads.size(); ++i) {
    const Carriageway& forward = network.roads[i].sides[0];
    if (forward.has_crossing()) add({.road = i}, forward.crossing);
  }
}

}  // namespace bevloc::sim
