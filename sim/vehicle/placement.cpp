#include "sim/vehicle/placement.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

constexpr double kSurroundings_m = 30.0;
constexpr int kWantedElements = 2;
constexpr int kAttempts = 30;

constexpr double kApart_m = 15.0;
constexpr double kApart_rad = radians(60.0);

bool is_near(const MapElement& element, const Eigen::Vector2d& point) {
  for (size_t i = 1; i < element.points.size(); ++i) {
    if (distance_to_segment(point, element.points[i - 1], element.points[i]) < kSurroundings_m) {
      return true;
    }
  }
  return false;
}

bool has_surroundings(const HdMap& map, const Eigen::Vector2d& point) {
  int found = 0;
  for (const MapElement& element : map.elements) {
    if (is_near(element, point) && ++found == kWantedElements) return true;
  }
  return false;
}

/// Draws a lane with a weight of the square root of its length, which favours the short lanes
/// across junctions.
const Lane& random_lane(const HdMap& map, Random& random) {
  double total = 0.0;
  for (const Lane& lane : map.lanes) total += std::sqrt(polyline_length(lane.centerline));
  double draw = random.uniform(0.0, total);
  for (const Lane& lane : map.lanes) {
    draw -= std::sqrt(polyline_length(lane.centerline));
    if (draw <= 0.0) return lane;
  }
  return map.lanes.back();
}

Se2 random_pose_on_lane(const Lane& lane, Random& random) {
  const Path path(lane.centerline);
  const double station_m = random.uniform(0.0, path.length_m());
  const double lane_width_m = (lane.left.front() - lane.right.front()).norm();
  double right_m = random.normal(0.0, 0.4);
  double askew_rad = radians(random.normal(0.0, 2.5));
  if (random.chance(0.15)) {  // a lane change
    right_m = random.uniform(-0.5, 0.5) * lane_width_m;
    askew_rad = radians(random.normal(0.0, 5.0));
  }
  const Eigen::Vector2d position = path.beside(station_m, right_m);
  return {position.x(), position.y(), wrap_angle(path.heading_rad(station_m) + askew_rad)};
}

}  // namespace

Se2 random_pose_on_road(const World& world, Random& random) {
  assert(!world.map.lanes.empty());
  Se2 pose;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    pose = random_pose_on_lane(random_lane(world.map, random), random);
    if (has_surroundings(world.map, pose.translation())) break;
  }
  return pose;
}

bool is_apart(const Se2& pose, std::span<const Se2> others) {
  return std::ranges::all_of(others, [&pose](const Se2& other) {
    return (pose.translation() - other.translation()).norm() > kApart_m ||
           std::abs(wrap_angle(pose.yaw_rad - other.yaw_rad)) > kApart_rad;
  });
}

}  // namespace bevloc::sim
