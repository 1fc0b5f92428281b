#include "sim/world/path.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace bevloc::sim {
namespace {

constexpr double kSampleStep_m = 1.0;

Polyline cubic_bezier(const Eigen::Vector2d& p0, const Eigen::Vector2d& c0,
                      const Eigen::Vector2d& c1, const Eigen::Vector2d& p1) {
  const double control_length = (c0 - p0).norm() + (c1 - c0).norm() + (p1 - c1).norm();
  const int pieces = std::max(6, static_cast<int>(std::ceil(control_length / 0.8)));
  Polyline line;
  line.reserve(static_cast<size_t>(pieces) + 1);
  for (int i = 0; i <= pieces; ++i) {
    const double t = static_cast<double>(i) / pieces;
    const double u = 1.0 - t;
    line.emplace_back(u * u * u * p0 + 3.0 * u * u * t * c0 + 3.0 * u * t * t * c1 +
                      t * t * t * p1);
  }
  return line;
}

}  // namespace

Path::Path(const Polyline& points) {
  for (const Eigen::Vector2d& point : points) {
    if (!points_.empty() && (point - points_.back()).norm() < 1e-6) continue;
    const double previous = stations_.empty() ? 0.0 : stations_.back();
    stations_.push_back(points_.empty() ? 0.0 : previous + (point - points_.back()).norm());
    points_.push_back(point);
  }
  assert(points_.size() >= 2);
  const size_t last = points_.size() - 1;
  directions_.resize(points_.size());
  for (size_t i = 0; i <= last; ++i) {
    // The chord between both neighbours follows the longer segment, so a straight that leads into
    // an arc keeps its direction.
    const Eigen::Vector2d& before = points_[i > 0 ? i - 1 : 0];
    const Eigen::Vector2d& after = points_[std::min(i + 1, last)];
    directions_[i] = (after - before).normalized();
  }
}

Path::Place Path::place_at(double station_m) const {
  const auto above = std::upper_bound(stations_.begin() + 1, stations_.end() - 1, station_m);
  const size_t i = static_cast<size_t>(above - stations_.begin()) - 1;
  return {i, (station_m - stations_[i]) / (stations_[i + 1] - stations_[i])};
}

Eigen::Vector2d Path::position(const Place& place) const {
  const size_t i = place.segment;
  return points_[i] + place.fraction * (points_[i + 1] - points_[i]);
}

Eigen::Vector2d Path::direction(const Place& place) const {
  const size_t i = place.segment;
  const double fraction = std::clamp(place.fraction, 0.0, 1.0);
  return (directions_[i] + fraction * (directions_[i + 1] - directions_[i])).normalized();
}

Eigen::Vector2d Path::position(double station_m) const {
  return position(place_at(station_m));
}

Eigen::Vector2d Path::direction(double station_m) const {
  return direction(place_at(station_m));
}

double Path::heading_rad(double station_m) const {
  const Eigen::Vector2d d = direction(station_m);
  return std::atan2(d.y(), d.x());
}

Eigen::Vector2d Path::beside(double station_m, double right_m) const {
  const Place place = place_at(station_m);
  return position(place) - right_m * left_of(direction(place));
}

Path Path::reversed() const {
  return Path(sim::reversed(points_));
}

Polyline Path::parallel(double from_m, double to_m,
                        const std::function<double(double)>& right_m) const {
  const int pieces =
      std::max(1, static_cast<int>(std::ceil(std::abs(to_m - from_m) / kSampleStep_m)));
  Polyline line;
  line.reserve(static_cast<size_t>(pieces) + 1);
  for (int i = 0; i <= pieces; ++i) {
    const double station = from_m + (to_m - from_m) * i / pieces;
    line.push_back(beside(station, right_m(station)));
  }
  return without_collinear(line);
}

Polyline Path::parallel(double from_m, double to_m, double right_m) const {
  return parallel(from_m, to_m, [right_m](double) { return right_m; });
}

Polyline without_collinear(const Polyline& line) {
  if (line.size() < 3) return line;
  constexpr double kStraight_rad = 2e-4;
  Polyline kept{line.front()};
  for (size_t i = 1; i + 1 < line.size(); ++i) {
    const Eigen::Vector2d before = line[i] - kept.back();
    const Eigen::Vector2d after = line[i + 1] - line[i];
    if (std::abs(cross(before, after)) > kStraight_rad * before.norm() * after.norm()) {
      kept.push_back(line[i]);
    }
  }
  kept.push_back(line.back());
  return kept;
}

Polyline smooth_turn(const Eigen::Vector2d& p0, const Eigen::Vector2d& d0,
                     const Eigen::Vector2d& p1, const Eigen::Vector2d& d1) {
  const double sine = cross(d0, d1);
  const Eigen::Vector2d chord = p1 - p0;
  if (std::abs(sine) > 0.05) {
    // The tangents meet `ahead` metres after p0 and `behind` metres before p1.
    const double ahead = cross(chord, d1) / sine;
    const double behind = cross(d0, chord) / sine;
    if (ahead > 0.3 && behind > 0.3) {
      const double tangent = std::min(ahead, behind);
      const double angle = std::acos(std::clamp(d0.dot(d1), -1.0, 1.0));
      const double handle = 4.0 / 3.0 * std::tan(angle / 4.0) * tangent / std::tan(angle / 2.0);
      const Eigen::Vector2d q0 = p0 + (ahead - tangent) * d0;
      const Eigen::Vector2d q1 = p1 - (behind - tangent) * d1;
      Polyline line{p0};
      append(line, cubic_bezier(q0, q0 + handle * d0, q1 - handle * d1, q1));
      append(line, {p1});
      return line;
    }
  }
  const double handle = 0.4 * chord.norm();
  return without_collinear(cubic_bezier(p0, p0 + handle * d0, p1 - handle * d1, p1));
}

Polyline rounded(const Polyline& waypoints, const std::vector<double>& tangent_m) {
  assert(waypoints.size() == tangent_m.size());
  Polyline line{waypoints.front()};
  for (size_t i = 1; i + 1 < waypoints.size(); ++i) {
    const Eigen::Vector2d before = (waypoints[i] - waypoints[i - 1]).normalized();
    const Eigen::Vector2d after = (waypoints[i + 1] - waypoints[i]).normalized();
    append(line, smooth_turn(waypoints[i] - tangent_m[i] * before, before,
                             waypoints[i] + tangent_m[i] * after, after));
  }
  append(line, {waypoints.back()});
  return line;
}

double smooth_step(double begin, double end, double value) {
  if (end <= begin) return value < begin ? 0.0 : 1.0;
  const double t = std::clamp((value - begin) / (end - begin), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

void append(Polyline& line, const Polyline& tail) {
  for (const Eigen::Vector2d& point : tail) {
    if (line.empty() || (point - line.back()).norm() > 1e-6) line.push_back(point);
  }
}

Polyline reversed(Polyline line) {
  std::reverse(line.begin(), line.end());
  return line;
}

}  // namespace bevloc::sim
