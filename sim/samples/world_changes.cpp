#include "sim/samples/world_changes.h"

#include <algorithm>
#include <cmath>

#include "sim/random.h"
#include "sim/vehicle/smooth_noise.h"
#include "sim/world/path.h"
#include "sim/world/traffic.h"
#include "sim/world/verge.h"

namespace bevloc::sim {
namespace {

/// The most wear, which is the same limit as in WorldBuilder.
constexpr double kMostWear = 0.95;

// Standing vehicles.
constexpr double kAround_m = 25.0;
constexpr double kSpotStep_m = 2.0;
constexpr double kShortestLane_m = 2.0;
constexpr double kClearance_m = 0.5;
constexpr double kAxleToMiddle_m = 1.4;

// Verges.
constexpr double kNarrowestVerge_m = 0.1;
constexpr double kWidestVerge_m = 1.5;

// Errors of the map.
constexpr double kShortestWave_m = 20.0;
constexpr double kLongestWave_m = 80.0;
constexpr double kLongestStep_m = 4.0;
constexpr double kNearestGhost_m = 1.5;
constexpr double kFarthestGhost_m = 4.0;

/// The body of the own vehicle.
VehicleBody ego_at(const Se2& map_from_vehicle) {
  VehicleBody ego;
  ego.centre = map_from_vehicle * Eigen::Vector2d(kAxleToMiddle_m, 0.0);
  ego.yaw_rad = map_from_vehicle.yaw_rad;
  return ego;
}

/// Whether two vehicles keep a distance. Approximates both as parallel to the first.
bool are_clear(const VehicleBody& a, const VehicleBody& b) {
  const Eigen::Vector2d between = b.centre - a.centre;
  const Eigen::Vector2d forward = unit_vector(a.yaw_rad);
  return std::abs(between.dot(forward)) > 0.5 * (a.length_m + b.length_m) + kClearance_m ||
         std::abs(cross(forward, between)) > 0.5 * (a.width_m + b.width_m) + kClearance_m;
}

/// Poses on the lanes around a place.
std::vector<Se2> spots_around(const Eigen::Vector2d& place, const HdMap& map) {
  std::vector<Se2> spots;
  for (const Lane& lane : map.lanes) {
    if (polyline_length(lane.centerline) < kShortestLane_m) continue;
    const Path path(lane.centerline);
    for (double s = 0.0; s < path.length_m(); s += kSpotStep_m) {
      const Eigen::Vector2d point = path.position(s);
      if ((point - place).norm() > kAround_m) continue;
      spots.push_back({point.x(), point.y(), path.heading_rad(s)});
    }
  }
  return spots;
}

/// A smooth random displacement field over the map.
class ShiftField {
 public:
  ShiftField(double sigma_m, uint64_t seed)
      : east_over_east_(component("east over east", sigma_m, seed)),
        east_over_north_(component("east over north", sigma_m, seed)),
        north_over_east_(component("north over east", sigma_m, seed)),
        north_over_north_(component("north over north", sigma_m, seed)) {}

  Eigen::Vector2d at(const Eigen::Vector2d& point) const {
    return {east_over_east_.at(point.x()) + east_over_north_.at(point.y()),
            north_over_east_.at(point.x()) + north_over_north_.at(point.y())};
  }

 private:
  static SmoothNoise component(std::string_view name, double sigma_m, uint64_t seed) {
    return {seed_for(seed, name), sigma_m / std::numbers::sqrt2, kShortestWave_m, kLongestWave_m};
  }

  SmoothNoise east_over_east_;
  SmoothNoise east_over_north_;
  SmoothNoise north_over_east_;
  SmoothNoise north_over_north_;
};

/// Adds points so that the line can be bent smoothly.
Polyline refined(const Polyline& line) {
  Polyline fine;
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    const double length = (line[i + 1] - line[i]).norm();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / kLongestStep_m)));
    for (int k = 0; k < steps; ++k) {
      fine.emplace_back(line[i] + static_cast<double>(k) / steps * (line[i + 1] - line[i]));
    }
  }
  fine.push_back(line.back());
  return fine;
}

/// Shifts an element. A crossing gets no extra points, because the rasterizer uses its longest
/// edges.
MapElement moved(const MapElement& element, const Eigen::Vector2d& aside, const ShiftField& field) {
  MapElement result = element;
  if (element.element_class != ElementClass::kPedestrianCrossing) {
    result.points = refined(element.points);
  }
  for (Eigen::Vector2d& point : result.points) point += aside + field.at(point);
  return result;
}

/// Draws the offset from an element to its copy beside it.
Eigen::Vector2d beside(const MapElement& element, Random& random) {
  const double distance_m = random.uniform(kNearestGhost_m, kFarthestGhost_m);
  const double side = random.chance(0.5) ? 1.0 : -1.0;
  const Eigen::Vector2d along = element.points.back() - element.points.front();
  return side * distance_m * left_of(along.normalized());
}

}  // namespace

void wear_paint(double factor, World& world) {
  const auto worn = [factor](float wear) {
    return std::max(wear, static_cast<float>(std::min(factor * wear, kMostWear)));
  };
  for (PaintLine& line : world.paint_lines) line.wear = worn(line.wear);
  for (PaintArea& area : world.paint_areas) area.wear = worn(area.wear);
}

void add_standing_vehicles(const std::vector<Se2>& poses, int count, uint64_t seed, World& world) {
  Random random(seed_for(seed, "standing vehicles"));
  for (const Se2& pose : poses) {
    std::vector<Se2> spots = spots_around(pose.translation(), world.map);
    const VehicleBody ego = ego_at(pose);
    for (int placed = 0; placed < count && !spots.empty();) {
      const size_t drawn = random.index(spots.size());
      VehicleBody body = random_vehicle(random);
      body.centre = spots[drawn].translation();
      body.yaw_rad = spots[drawn].yaw_rad;
      spots.erase(spots.begin() + static_cast<std::ptrdiff_t>(drawn));
      const auto is_clear = [&body](const VehicleBody& other) { return are_clear(other, body); };
      if (!is_clear(ego) || !std::ranges::all_of(world.parked, is_clear)) continue;
      world.parked.push_back(body);
      ++placed;
    }
  }
}

void add_verges(double share, uint64_t seed, World& world) {
  if (share <= 0.0) return;
  Random random(seed_for(seed, "verges"));
  grow_verges(world, [&] {
    const bool grows = random.chance(share);
    const double width_m = random.uniform(kNarrowestVerge_m, kWidestVerge_m);
    const bool is_dirt = random.chance(0.3);
    return Verge{grows ? width_m : 0.0, is_dirt ? GroundMaterial::kDirt : GroundMaterial::kGrass};
  });
}

HdMap with_errors(const HdMap& map, const MapErrors& errors, uint64_t seed) {
  if (errors == MapErrors{}) return map;
  Random random(seed_for(seed, "map errors"));
  const ShiftField field(errors.shift_sigma_m, seed);
  HdMap wrong = map;
  wrong.elements.clear();
  for (const MapElement& element : map.elements) {
    const bool missing = random.chance(errors.omission);
    const bool doubled = random.chance(errors.ghost);
    const Eigen::Vector2d aside = beside(element, random);
    if (!missing) wrong.elements.push_back(moved(element, Eigen::Vector2d::Zero(), field));
    if (doubled) wrong.elements.push_back(moved(element, aside, field));
  }
  return wrong;
}

}  // namespace bevloc::sim
