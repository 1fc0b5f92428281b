#include "sim/world/world_builder.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace bevloc::sim {
namespace {

Rgb grey(double value) {
  const auto v = static_cast<float>(value);
  return {v, v, v};
}

/// The corners of a crossing. The sides 0-1 and 3-2 are the long ones (the walking direction).
std::array<Eigen::Vector2d, 4> crossing_corners(const Ring& ring) {
  std::array<Eigen::Vector2d, 4> corner;
  if (ring.size() == 4) {
    std::copy(ring.begin(), ring.end(), corner.begin());
  } else {
    std::vector<cv::Point2f> points;
    for (const Eigen::Vector2d& p : ring) {
      points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    }
    std::array<cv::Point2f, 4> box;
    cv::minAreaRect(points).points(box.data());
    for (size_t i = 0; i < 4; ++i) corner[i] = {box[i].x, box[i].y};
  }
  const double first = (corner[1] - corner[0]).norm() + (corner[2] - corner[3]).norm();
  const double second = (corner[2] - corner[1]).norm() + (corner[3] - corner[0]).norm();
  if (second > first) std::rotate(corner.begin(), corner.begin() + 1, corner.end());
  return corner;
}

}  // namespace

void WorldBuilder::add_surface(Layer layer, Ring ring, GroundMaterial material, float brightness) {
  layers_[static_cast<size_t>(layer)].push_back({material, brightness, std::move(ring)});
}

float WorldBuilder::varied(float wear) {
  return static_cast<float>(std::clamp(wear + random_.normal(0.0, 0.08), 0.0, 0.95));
}

void WorldBuilder::add_element(ElementClass element_class, Appearance appearance,
                               const Polyline& points) {
  const double y_m = random_.normal(0.0, town_.map_shift_m);
  const double x_m = random_.normal(0.0, town_.map_shift_m);
  const Eigen::Vector2d shift(x_m, y_m);
  MapElement element{element_class, appearance, points};
  for (Eigen::Vector2d& point : element.points) point += shift;
  world_.map.elements.push_back(std::move(element));
}

void WorldBuilder::add_divider(const Polyline& line, const DividerPaint& paint, float wear) {
  const bool in_map = !random_.chance(town_.map_omission);
  const bool on_road = !random_.chance(town_.map_ghost);
  if (in_map || !on_road) add_element(ElementClass::kLaneDivider, paint.appearance, line);
  if (on_road) paint_divider(line, paint, wear);
}

void WorldBuilder::paint_divider(const Polyline& line, const DividerPaint& paint, float wear) {
  PaintLine stripe{.points = line,
                   .width_m = paint.width_m,
                   .phase_m = random_.uniform(0.0, 10.0),
                   .albedo = paint.albedo,
                   .wear = varied(wear)};
  if (paint.appearance == Appearance::kDashed) {
    stripe.dash_m = paint.dash_m;
    stripe.gap_m = paint.gap_m;
  }
  if (paint.appearance != Appearance::kDoubleSolid) {
    world_.paint_lines.push_back(std::move(stripe));
    return;
  }
  const Path path(line);
  const double spacing_m = paint.width_m + random_.uniform(0.08, 0.2);
  const bool one_is_dashed = random_.chance(0.15);
  for (const double side : {-0.5, 0.5}) {
    stripe.points = path.parallel(0.0, path.length_m(), side * spacing_m);
    const bool dashed = one_is_dashed && side > 0.0;
    stripe.dash_m = dashed ? paint.dash_m : 0.0;
    stripe.gap_m = dashed ? paint.gap_m : 0.0;
    world_.paint_lines.push_back(stripe);
  }
}

void WorldBuilder::add_edge_line(const Polyline& line, double width_m, const Rgb& albedo,
                                 float wear) {
  if (town_.map_lists_edge_lines) {
    add_element(ElementClass::kLaneDivider, Appearance::kSolid, line);
  }
  world_.paint_lines.push_back(
      {.points = line, .width_m = width_m, .albedo = albedo, .wear = varied(wear)});
}

void WorldBuilder::add_paint_area(Ring ring, const Rgb& albedo, float wear) {
  world_.paint_areas.push_back({std::move(ring), albedo, varied(wear)});
}

void WorldBuilder::add_crossing(const Ring& ring, Appearance appearance, float wear) {
  const bool in_map = !random_.chance(town_.map_omission);
  const bool on_road = !random_.chance(town_.map_ghost);
  if (in_map || !on_road) add_element(ElementClass::kPedestrianCrossing, appearance, ring);
  if (on_road) paint_crossing(ring, appearance, wear);
}

void WorldBuilder::paint_crossing(const Ring& ring, Appearance appearance, float wear) {
  const auto corner = crossing_corners(ring);
  const double length = 0.5 * ((corner[1] - corner[0]).norm() + (corner[2] - corner[3]).norm());
  const double width = 0.5 * ((corner[3] - corner[0]).norm() + (corner[2] - corner[1]).norm());
  if (length < 0.5 || width < 0.5) return;
  const auto at = [&](double u, double v) -> Eigen::Vector2d {
    return (1.0 - v) * ((1.0 - u) * corner[0] + u * corner[1]) +
           v * ((1.0 - u) * corner[3] + u * corner[2]);
  };
  if (appearance != Appearance::kUnknown) {
    const double bar = town_.crossing_bar_m;
    const int bars = std::max(1, static_cast<int>(length / (2.0 * bar)));
    for (int i = 0; i < bars; ++i) {
      const double u0 = (i + 0.25) / bars;
      const double u1 = u0 + 0.5 / bars;
      add_paint_area({at(u0, 0.0), at(u1, 0.0), at(u1, 1.0), at(u0, 1.0)}, kWhitePaint, wear);
    }
  }
  if (appearance != Appearance::kZebra) {
    const double v = std::min(0.4, random_.uniform(0.15, 0.4) / width);
    add_paint_area({at(0.0, 0.0), at(1.0, 0.0), at(1.0, v), at(0.0, v)}, kWhitePaint, wear);
    add_paint_area({at(0.0, 1.0 - v), at(1.0, 1.0 - v), at(1.0, 1.0), at(0.0, 1.0)}, kWhitePaint,
                   wear);
  }
}

void WorldBuilder::add_boundary(const Polyline& line, const EdgeStyle& edge) {
  const bool in_map = !random_.chance(town_.map_omission);
  if (in_map) add_element(ElementClass::kRoadBoundary, edge.boundary, line);
  build_boundary(line, edge);
}

void WorldBuilder::add_map_boundary(const Polyline& line, Appearance appearance) {
  add_element(ElementClass::kRoadBoundary, appearance, line);
}

void WorldBuilder::build_boundary(const Polyline& line, const EdgeStyle& edge) {
  switch (edge.boundary) {
    case Appearance::kKerb: {
      const Rgb paint = edge.kerb == WallTexture::kKerbPainted ? Rgb{0.7F, 0.55F, 0.1F}
                                                               : grey(random_.uniform(0.3, 0.6));
      add_wall(line, edge.kerb, 0.0, edge.kerb_height_m, paint);
      break;
    }
    case Appearance::kBarrier:
      add_grey_wall(line, WallTexture::kConcreteBarrier, {0.6, 1.1}, {0.35, 0.65});
      break;
    case Appearance::kGuardRail:
      add_wall(line, WallTexture::kGuardRail, 0.4, 0.75, grey(random_.uniform(0.4, 0.65)));
      break;
    case Appearance::kWall:
      add_grey_wall(line, WallTexture::kStoneWall, {0.5, 2.5}, {0.25, 0.6});
      break;
    case Appearance::kFence:
      add_grey_wall(line, WallTexture::kFence, {0.9, 2.0}, {0.15, 0.6});
      break;
    case Appearance::kHedge:
      add_wall(line, WallTexture::kHedge, 0.0, random_.uniform(0.6, 2.2), kHedgeGreen);
      break;
    default:
      break;  // at a road edge only the ground changes
  }
}

void WorldBuilder::add_grey_wall(const Polyline& base, WallTexture texture,
                                 std::array<double, 2> top_m, std::array<double, 2> shade) {
  const Rgb albedo = grey(random_.uniform(shade[0], shade[1]));
  add_wall(base, texture, 0.0, random_.uniform(top_m[0], top_m[1]), albedo);
}

void WorldBuilder::add_wall(const Polyline& base, WallTexture texture, double bottom_m,
                            double top_m, const Rgb& albedo) {
  world_.walls.push_back(
      {base, bottom_m, top_m, texture, albedo, static_cast<uint32_t>(random_.bits())});
}

std::vector<const Ring*> WorldBuilder::paved_rings() const {
  std::vector<const Ring*> rings;
  for (const Layer layer : {Layer::kSidewalk, Layer::kDriveway, Layer::kCarriageway}) {
    for (const Surface& surface : layers_[static_cast<size_t>(layer)]) {
      rings.push_back(&surface.ring);
    }
  }
  return rings;
}

World WorldBuilder::finish() {
  for (std::vector<Surface>& layer : layers_) {
    for (Surface& surface : layer) world_.surfaces.push_back(std::move(surface));
    layer.clear();
  }
  return std::move(world_);
}

}  // namespace bevloc::sim
