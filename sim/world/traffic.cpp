#include "sim/world/traffic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

constexpr double kRoute_m = 500.0;

Rgb vehicle_colour(Random& random) {
  const double draw = random.uniform();
  const auto shade = static_cast<float>(random.uniform());
  if (draw < 0.3) return {0.6F + 0.3F * shade, 0.6F + 0.3F * shade, 0.6F + 0.3F * shade};
  if (draw < 0.55) return {0.02F + 0.1F * shade, 0.02F + 0.1F * shade, 0.03F + 0.1F * shade};
  if (draw < 0.75) return {0.25F + 0.2F * shade, 0.25F + 0.2F * shade, 0.27F + 0.2F * shade};
  return {static_cast<float>(random.uniform(0.02, 0.6)),
          static_cast<float>(random.uniform(0.02, 0.5)),
          static_cast<float>(random.uniform(0.02, 0.6))};
}

/// Joins lane centre lines along random successors until the route is kRoute_m long.
Polyline random_route(const HdMap& map, uint32_t lane, Random& random) {
  Polyline route = map.lanes[lane].centerline;
  double travelled_m = polyline_length(route);
  while (travelled_m < kRoute_m && !map.lanes[lane].successors.empty()) {
    const std::vector<uint32_t>& next = map.lanes[lane].successors;
    lane = next[random.index(next.size())];
    travelled_m += std::max(polyline_length(map.lanes[lane].centerline), kLeastStep_m);
    append(route, map.lanes[lane].centerline);
  }
  return route;
}

/// Finds positions along a polyline for increasing stations. Beyond the end, the position is the
/// last point.
class Walker {
 public:
  explicit Walker(const Polyline& line) : line_(line) {}

  /// Stations must not decrease from call to call.
  Eigen::Vector2d at(double station_m) {
    while (true) {
      const Eigen::Vector2d step = line_[segment_ + 1] - line_[segment_];
      const double length = step.norm();
      const bool last = segment_ + 2 == line_.size();
      if (station_m <= start_m_ + length || last) {
        return line_[segment_] + step * std::min(1.0, (station_m - start_m_) / length);
      }
      start_m_ += length;
      ++segment_;
    }
  }

 private:
  const Polyline& line_;
  size_t segment_ = 0;
  double start_m_ = 0.0;
};

VehicleBody placed_on_path(const TrafficVehicle& vehicle, double seconds) {
  constexpr double kHalfWheelbase_m = 1.4;
  VehicleBody body = vehicle.body;
  const double route_m = polyline_length(vehicle.path);
  const double usable_m = std::max(1e-3, route_m - 2.0 * kHalfWheelbase_m);
  const double driven_m = std::fmod(vehicle.start_m + vehicle.speed_mps * seconds, usable_m);
  Walker walker(vehicle.path);
  const Eigen::Vector2d rear = walker.at(driven_m);
  const Eigen::Vector2d front = walker.at(driven_m + 2.0 * kHalfWheelbase_m);
  body.centre = 0.5 * (rear + front);
  const Eigen::Vector2d forward = front - rear;
  body.yaw_rad = std::atan2(forward.y(), forward.x());
  return body;
}

}  // namespace

VehicleBody random_vehicle(Random& random) {
  VehicleBody body;
  const double draw = random.uniform();
  if (draw < 0.78) {
    body.kind = VehicleKind::kCar;
    body.length_m = random.uniform(3.6, 4.9);
    body.width_m = random.uniform(1.65, 1.95);
    body.height_m = random.uniform(1.35, 1.8);
  } else if (draw < 0.91) {
    body.kind = VehicleKind::kVan;
    body.length_m = random.uniform(4.6, 6.2);
    body.width_m = random.uniform(1.85, 2.1);
    body.height_m = random.uniform(1.9, 2.6);
  } else if (draw < 0.96) {
    body.kind = VehicleKind::kTruck;
    body.length_m = random.uniform(6.5, 10.5);
    body.width_m = random.uniform(2.2, 2.5);
    body.height_m = random.uniform(2.7, 3.8);
  } else {
    body.kind = VehicleKind::kBus;
    body.length_m = random.uniform(9.0, 12.0);
    body.width_m = 2.5;
    body.height_m = random.uniform(2.9, 3.2);
  }
  body.albedo = vehicle_colour(random);
  return body;
}

std::vector<TrafficVehicle> random_traffic(const HdMap& map, double density, Random& random) {
  std::vector<TrafficVehicle> traffic;
  double lanes_m = 0.0;
  for (const Lane& lane : map.lanes) lanes_m += polyline_length(lane.centerline);
  const int count = map.lanes.empty() ? 0 : static_cast<int>(0.01 * density * lanes_m);
  for (int i = 0; i < count; ++i) {
    const auto lane = static_cast<uint32_t>(random.index(map.lanes.size()));
    TrafficVehicle vehicle;
    vehicle.body = random_vehicle(random);
    vehicle.path = random_route(map, lane, random);
    vehicle.start_m = random.uniform() * polyline_length(vehicle.path);
    const bool queues = random.chance(0.15);
    vehicle.speed_mps = queues ? 0.0 : random.uniform(4.0, map.lanes[lane].speed_limit_mps);
    if (vehicle.path.size() >= 2) traffic.push_back(std::move(vehicle));
  }
  return traffic;
}

std::vector<VehicleBody> traffic_at(const std::vector<TrafficVehicle>& traffic, double seconds) {
  std::vector<VehicleBody> bodies;
  bodies.reserve(traffic.size());
  for (const TrafficVehicle& vehicle : traffic) bodies.push_back(placed_on_path(vehicle, seconds));
  return bodies;
}

}  // namespace bevloc::sim
