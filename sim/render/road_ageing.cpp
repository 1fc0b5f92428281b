#include "sim/render/road_ageing.h"

#include <algorithm>
#include <cmath>

#include "sim/random.h"
#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

constexpr double kTrackWidthM = 1.5;  ///< distance between the left and right wheels

/// A place on a polyline.
struct OnLine {
  Eigen::Vector2d position;
  Eigen::Vector2d direction;
};

OnLine point_on(const Polyline& points, double at_m) {
  for (size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d edge = points[i] - points[i - 1];
    const double length_m = edge.norm();
    if (length_m > 0.0 && (at_m <= length_m || i + 1 == points.size())) {
      return {points[i - 1] + edge * (at_m / length_m), edge / length_m};
    }
    at_m -= length_m;
  }
  return {points.front(), Eigen::Vector2d::UnitX()};
}

/// A parallel line.
Polyline shifted(const Polyline& points, double left_m) {
  Polyline result;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d chord =
        points[std::min(i + 1, points.size() - 1)] - points[i == 0 ? 0 : i - 1];
    const Eigen::Vector2d direction = chord.normalized();
    result.push_back(points[i] + left_m * left_of(direction));
  }
  return result;
}

void add_patch(const Polyline& centerline, double at_m, uint64_t seed, RoadAgeing& ageing) {
  Random random(seed);
  const OnLine place = point_on(centerline, at_m);
  const Eigen::Vector2d centre =
      place.position + random.uniform(-1.2, 1.2) * left_of(place.direction);
  const double turn_rad = random.normal(0.0, 0.05);
  const Eigen::Vector2d along =
      std::cos(turn_rad) * place.direction + std::sin(turn_rad) * left_of(place.direction);
  const Eigen::Vector2d half_length = random.uniform(0.3, 2.5) * along;
  const Eigen::Vector2d half_width = random.uniform(0.25, 0.9) * left_of(along);
  ageing.patches.push_back({{centre - half_length - half_width, centre + half_length - half_width,
                             centre + half_length + half_width, centre - half_length + half_width},
                            static_cast<float>(random.uniform(0.6, 1.15))});
}

void add_crack(const Polyline& centerline, double at_m, uint64_t seed, RoadAgeing& ageing) {
  Random random(seed);
  const OnLine place = point_on(centerline, at_m);
  Eigen::Vector2d position = place.position + random.uniform(-1.6, 1.6) * left_of(place.direction);
  double heading_rad = random.chance(0.5) ? 0.0 : 1.57;
  const double base_rad = std::atan2(place.direction.y(), place.direction.x());
  Polyline points{position};
  const int steps = random.integer(4, 12);
  for (int step = 0; step < steps; ++step) {
    const double bearing_rad = base_rad + heading_rad + random.normal(0.0, 0.35);
    position += random.uniform(0.2, 0.6) * unit_vector(bearing_rad);
    heading_rad += random.normal(0.0, 0.1);
    points.push_back(position);
  }
  // Some cracks are open, others are sealed with a band of tar.
  const bool sealed = random.chance(0.4);
  ageing.soilings.push_back({sealed ? random.uniform(0.06, 0.1) : random.uniform(0.02, 0.04),
                             static_cast<float>(random.uniform(0.35, 0.6))});
  append_segments(points, static_cast<int>(ageing.soilings.size()) - 1, ageing.cracks);
}

void age_lane(const Lane& lane, uint64_t seed, RoadAgeing& ageing) {
  constexpr double kMetresPerFlaw = 14.0;
  Random random(seed);
  const auto strength = static_cast<float>(random.uniform(0.0, 0.16));
  for (const double side : {-0.5, 0.5}) {
    ageing.soilings.push_back({0.7, strength});
    append_segments(shifted(lane.centerline, side * kTrackWidthM),
                    static_cast<int>(ageing.soilings.size()) - 1, ageing.tracks);
  }
  const double lane_m = polyline_length(lane.centerline);
  for (double at_m = random.uniform(0.0, kMetresPerFlaw); at_m < lane_m;
       at_m += random.uniform(0.2, 1.8) * kMetresPerFlaw) {
    if (random.chance(0.3)) {
      add_patch(lane.centerline, at_m, random.bits(), ageing);
    } else {
      add_crack(lane.centerline, at_m, random.bits(), ageing);
    }
  }
}

}  // namespace

RoadAgeing age_roads(const World& world) {
  RoadAgeing ageing;
  const uint64_t seed = seed_for(world.seed, "road ageing");
  for (size_t i = 0; i < world.map.lanes.size(); ++i) {
    const Lane& lane = world.map.lanes[i];
    if (lane.centerline.size() >= 2) age_lane(lane, mix_seed(seed + i), ageing);
  }
  return ageing;
}

}  // namespace bevloc::sim
