#include "evaluation/bench/repeated_town.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/map_points.h"

namespace bevloc::bench {
namespace {

constexpr double kM_per_km = 1e3;
/// Gap between copies.
constexpr double kGap_m = 100.0;

double element_km(const MapElement& element) {
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
    km += element_km(part.elements.back());
  }
  return part;
}

}  // namespace

double road_km(const HdMap& map) {
  double km = 0.0;
  for (const MapElement& element : map.elements) km += element_km(element);
  return km;
}

HdMap repeated_town(const HdMap& map, const Eigen::Vector2d& place, double wanted_km) {
  const double town_km = road_km(map);
  if (wanted_km < town_km || town_km == 0.0) return nearest_part(map, place, wanted_km);
  const auto copies = static_cast<size_t>(std::lround(wanted_km / town_km));
  const auto side = static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(copies))));
  const Eigen::Vector2d pitch = bounds_of(map).sizes() + Eigen::Vector2d::Constant(kGap_m);
  HdMap repeated;
  repeated.elements.reserve(copies * map.elements.size());
  for (size_t copy = 0; copy < copies; ++copy) {
    const Eigen::Vector2d moved(pitch.x() * static_cast<double>(copy % side),
                                pitch.y() * static_cast<double>(copy / side));
    for (const MapElement& element : map.elements) {
      repeated.elements.push_back(element);
      for (Eigen::Vector2d& point : repeated.elements.back().points) point += moved;
    }
  }
  return repeated;
}

}  // namespace bevloc::bench
