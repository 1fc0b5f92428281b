#include "sim/faults/map_faults.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/map/map_points.h"
#include "sim/world/path.h"
#include "sim/world/road_side.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {
namespace {

/// How densely the vehicle's way is sampled to cut the map along it.
constexpr double kCutStep_s = 0.5;

void shift(HdMap& map, const FaultAmounts& by, const Drive& drive) {
  const Eigen::Vector2d pivot = drive.at(0.0).map_from_vehicle.translation();
  const Se2 displaced{by.east_m, by.north_m, radians(by.yaw_deg)};
  move_points(map, [&](const Eigen::Vector2d& point) -> Eigen::Vector2d {
    return pivot + displaced * Eigen::Vector2d(point - pivot);
  });
}

/// The vehicle's places while the fault is active.
Polyline places_of(const Fault& fault, const Drive& drive) {
  Polyline places;
  const double end_s = std::min(fault.until_s, drive.duration_s());
  for (double time_s = fault.from_s; time_s < end_s; time_s += kCutStep_s) {
    places.push_back(drive.at(time_s).map_from_vehicle.translation());
  }
  return places;
}

/// Keeps the pieces of an element that are not near the places. A crossing near them is removed as
/// a whole.
void keep_far_pieces(const MapElement& element, const Polyline& places, double radius_m,
                     std::vector<MapElement>& kept) {
  const auto is_near = [&](const Eigen::Vector2d& point) {
    return std::ranges::any_of(places, [&](const Eigen::Vector2d& place) {
      return (place - point).squaredNorm() < radius_m * radius_m;
    });
  };
  if (element.element_class == ElementClass::kPedestrianCrossing) {
    if (std::ranges::none_of(element.points, is_near)) kept.push_back(element);
    return;
  }
  if (element.points.size() < 2 || polyline_length(element.points) <= 0.0) return;
  // The line is sampled, because a long segment may be near although both of its ends are far away.
  const Path path(element.points);
  const auto steps = static_cast<int>(std::ceil(path.length_m()));
  Polyline points;
  for (int step = 0; step <= steps; ++step) {
    points.push_back(path.position(path.length_m() * step / steps));
  }
  if (std::ranges::none_of(points, is_near)) {
    kept.push_back(element);
    return;
  }
  MapElement piece{element.element_class, element.appearance, {}};
  const auto finish_piece = [&] {
    if (piece.points.size() >= 2) kept.push_back(piece);
    piece.points.clear();
  };
  for (const Eigen::Vector2d& point : points) {
    if (is_near(point)) {
      finish_piece();
    } else {
      piece.points.push_back(point);
    }
  }
  finish_piece();
}

void cut(HdMap& map, const Fault& fault, const Drive& drive) {
  const Polyline places = places_of(fault, drive);
  std::vector<MapElement> kept;
  for (const MapElement& element : map.elements) {
    keep_far_pieces(element, places, fault.amounts.radius_m, kept);
  }
  map.elements = std::move(kept);
}

/// Puts another town's map in the place of this one, so that a drive through the other town would
/// begin where ours does.
void replace(HdMap& map, const FaultAmounts& by, const Drive& drive) {
  const auto seed = static_cast<uint64_t>(by.seed);
  const World other = generate_world(seed);
  const Drive other_drive(other, seed, 1.0);
  const Se2 ours_from_others =
      drive.at(0.0).map_from_vehicle * other_drive.at(0.0).map_from_vehicle.inverse();
  const GeoOrigin origin = map.origin;
  map = other.map;
  map.origin = origin;
  move_points(map, [&](const Eigen::Vector2d& point) { return ours_from_others * point; });
}

void displace_borders(HdMap& map, double outwards_m) {
  for (const RoadsideBoundary& boundary : boundaries_beside_road(map)) {
    const double right_m = boundary.side.is_right ? -outwards_m : outwards_m;
    map.elements[boundary.element].points =
        boundary.path.parallel(0.0, boundary.path.length_m(), right_m);
  }
}

}  // namespace

HdMap with_faults(HdMap map, std::span<const Fault> faults, const Drive& drive) {
  for (const Fault& fault : faults) {
    switch (fault.kind) {
      case FaultKind::kMapShifted:
        shift(map, fault.amounts, drive);
        break;
      case FaultKind::kMapCut:
        cut(map, fault, drive);
        break;
      case FaultKind::kMapOfElsewhere:
        replace(map, fault.amounts, drive);
        break;
      case FaultKind::kMapBorderOff:
        displace_borders(map, fault.amounts.outwards_m);
        break;
      default:
        break;
    }
  }
  return map;
}

}  // namespace bevloc::sim
