#include "pipeline/calibration/refine/paint_lines.h"

#include <cmath>

namespace bevloc {
namespace {

constexpr double kPaintStep_m = 0.2;

Eigen::Vector2d left_of_direction(const Eigen::Vector2d& direction) {
  return {-direction.y(), direction.x()};
}

/// Whether this side of a ring of four corners is one of the two longer ones.
bool is_long_side(const std::vector<Eigen::Vector2d>& ring, size_t first) {
  const auto length_of = [&ring](size_t i) {
    return (ring[(i + 1) % ring.size()] - ring[i % ring.size()]).norm();
  };
  return length_of(first) + length_of(first + 2) > length_of(first + 1) + length_of(first + 3);
}

}  // namespace

void find_paint_points(const MapIndex& map, const Se2& map_from_vehicle, double reach_m,
                       std::vector<PaintPoint>& points) {
  points.clear();
  std::vector<MapIndex::Segment> segments;
  const Eigen::Vector2d reach(reach_m, reach_m);
  const Eigen::Vector2d here = map_from_vehicle.translation();
  map.query(here - reach, here + reach, segments);
  for (const MapIndex::Segment& segment : segments) {
    const MapElement& element = map.map().elements[segment.element];
    if (element.element_class == ElementClass::kRoadBoundary) continue;
    if (element.appearance == Appearance::kDoubleSolid) continue;
    const bool crossing = element.element_class == ElementClass::kPedestrianCrossing;
    if (crossing && (element.points.size() != 4 || !is_long_side(element.points, segment.first))) {
      continue;
    }
    const Eigen::Vector2d& from = element.points[segment.first];
    const Eigen::Vector2d& to = segment_end(element, segment.first);
    const double length_m = (to - from).norm();
    if (length_m < kPaintStep_m) continue;
    PaintPoint point;
    point.along = (to - from) / length_m;
    point.across = left_of_direction(point.along);
    point.kind = crossing ? PaintKind::kStep : PaintKind::kStripe;
    point.element = segment.element;
    if (crossing) {
      const Eigen::Vector2d opposite = element.points[(segment.first + 2) % element.points.size()];
      if (point.across.dot(opposite - from) < 0.0) point.across = -point.across;
    }
    const int steps = static_cast<int>(length_m / kPaintStep_m);
    for (int i = 0; i < steps; ++i) {
      point.point_m = from + (i + 0.5) * length_m / steps * point.along;
      if ((point.point_m - here).norm() <= reach_m) points.push_back(point);
    }
  }
}

}  // namespace bevloc
