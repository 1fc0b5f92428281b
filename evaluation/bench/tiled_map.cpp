#include "evaluation/bench/tiled_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/map/lanelet_geometry.h"

namespace bevloc::bench {
namespace {

constexpr double kM_per_km = 1e3;
/// Gap between copies.
constexpr double kGap_m = 100.0;

double road_km(const MapElement& element) {
  if (element.element_class != ElementClass::kRoadBoundary) return 0.0;
  return 0.5 * polyline_length(element.points) / kM_per_km;
}

double distance_m(const MapElement& element, const Eigen::Vector2d& place) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& point : element.points) {
    least_m = std::min(least_m, (point - place).norm());
  }
  return least_m;
}

HdMap nearest_part(const HdMap& map, const Eigen::Vector2d& place, double wanted_km) {
  std::vector<std::pair<double, const MapElement*>> by_distance;
  for (const MapElement& element : map.elements) {
    by_distance.emplace_back(distance_m(element, place), &element);
  }
  std::ranges::stable_sort(by_distance, {}, &std::pair<double, const MapElement*>::first);
  HdMap part;
  double km = 0.0;
  for (size_t i = 0; i < by_distance.size() && km < wanted_km; ++i) {
    part.elements.push_back(*by_distance[i].second);
    km += road_km(part.elements.back());
  }
  return part;
}

Eigen::Vector2d extent_of(const HdMap& map) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Eigen::Vector2d low(kFar, kFar);
  Eigen::Vector2d high = -low;
  for (const MapElement& element : map.elements) {
    for (const Eigen::Vector2d& point : element.points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  return high - low;
}

}  // namespace

double road_km(const HdMap& map) {
  double km = 0.0;
  for (const MapElement& element : map.elements) km += road_km(element);
  return km;
}

HdMap tiled_map(const HdMap& map, const Eigen::Vector2d& place, double wanted_km) {
  const double tile_km = road_km(map);
  if (wanted_km < tile_km || tile_km == 0.0) return nearest_part(map, place, wanted_km);
  const auto copies = static_cast<size_t>(std::lround(wanted_km / tile_km));
  const auto side = static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(copies))));
  const Eigen::Vector2d pitch = extent_of(map) + Eigen::Vector2d::Constant(kGap_m);
  HdMap tiled;
  tiled.elements.reserve(copies * map.elements.size());
  for (size_t copy = 0; copy < copies; ++copy) {
    const Eigen::Vector2d moved(pitch.x() * static_cast<double>(copy % side),
                                pitch.y() * static_cast<double>(copy / side));
    for (const MapElement& element : map.elements) {
      tiled.elements.push_back(element);
      for (Eigen::Vector2d& point : tiled.elements.back().points) point += moved;
    }
  }
  return tiled;
}

}  // namespace bevloc::bench
