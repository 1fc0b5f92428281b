#include "sim/world/road_side.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace bevloc::sim {
namespace {

constexpr double kVoteStep_m = 1.0;
/// A lane farther away than this does not belong to the boundary. This is also the size of a cell.
constexpr double kFarthestLane_m = 8.0;

uint64_t cell_key(int64_t east, int64_t north) {
  return (static_cast<uint64_t>(east) << 32U) ^ static_cast<uint32_t>(north);
}

int64_t cell_of(double coordinate_m) {
  return static_cast<int64_t>(std::floor(coordinate_m / kFarthestLane_m));
}

}  // namespace

RoadSide::RoadSide(const HdMap& map) {
  for (const Lane& lane : map.lanes) {
    if (lane.centerline.size() < 2 || polyline_length(lane.centerline) <= 0.0) continue;
    const Path path(lane.centerline);
    const auto steps = static_cast<int>(std::ceil(path.length_m() / kVoteStep_m));
    for (int step = 0; step <= steps; ++step) {
      const Eigen::Vector2d point = path.position(path.length_m() * step / steps);
      centres_[cell_key(cell_of(point.x()), cell_of(point.y()))].push_back(point);
    }
  }
}

std::optional<Eigen::Vector2d> RoadSide::nearest_centre(const Eigen::Vector2d& point) const {
  std::optional<Eigen::Vector2d> nearest;
  double nearest_m = kFarthestLane_m;
  for (int64_t east = cell_of(point.x()) - 1; east <= cell_of(point.x()) + 1; ++east) {
    for (int64_t north = cell_of(point.y()) - 1; north <= cell_of(point.y()) + 1; ++north) {
      const auto cell = centres_.find(cell_key(east, north));
      if (cell == centres_.end()) continue;
      for (const Eigen::Vector2d& centre : cell->second) {
        const double distance_m = (centre - point).norm();
        if (distance_m >= nearest_m) continue;
        nearest_m = distance_m;
        nearest = centre;
      }
    }
  }
  return nearest;
}

std::optional<RoadSide::Side> RoadSide::of(const Path& boundary) const {
  int votes = 0;
  double least_m = std::numeric_limits<double>::infinity();
  const auto steps = static_cast<int>(std::ceil(boundary.length_m() / kVoteStep_m));
  for (int step = 0; step <= steps; ++step) {
    const double station_m = boundary.length_m() * step / steps;
    const Eigen::Vector2d point = boundary.position(station_m);
    const auto centre = nearest_centre(point);
    if (!centre) continue;
    const bool is_left = left_of(boundary.direction(station_m)).dot(*centre - point) > 0.0;
    votes += is_left ? -1 : 1;
    least_m = std::min(least_m, (*centre - point).norm());
  }
  if (!std::isfinite(least_m)) return std::nullopt;
  return Side{votes > 0, least_m};
}

std::vector<RoadsideBoundary> boundaries_beside_road(const HdMap& map, double least_m) {
  const RoadSide road(map);
  std::vector<RoadsideBoundary> boundaries;
  for (size_t i = 0; i < map.elements.size(); ++i) {
    const MapElement& element = map.elements[i];
    if (element.element_class != ElementClass::kRoadBoundary) continue;
    const double length_m = polyline_length(element.points);
    if (length_m <= 0.0 || length_m < least_m) continue;
    Path path(element.points);
    if (const auto side = road.of(path)) boundaries.push_back({i, std::move(path), *side});
  }
  return boundaries;
}

}  // namespace bevloc::sim
