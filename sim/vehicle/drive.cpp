#include "sim/vehicle/drive.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "sim/vehicle/route.h"
#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

constexpr double kStep_m = 0.5;
// These are below the limits promised in drive.h, to leave a margin.
constexpr double kLateralLimit_mps2 = 2.2;
constexpr double kAcceleration_mps2 = 1.6;
constexpr double kBraking_mps2 = 2.3;
constexpr double kTopSpeed_mps = 25.0;
constexpr double kStopBeforeLaneEnd_m = 7.0;
constexpr double kWander_m = 0.15;

/// Resamples a line to points about kStep_m apart.
Polyline resampled(const Polyline& line) {
  const Path path(line);
  const auto pieces =
      std::max<size_t>(4, static_cast<size_t>(std::lround(path.length_m() / kStep_m)));
  Polyline samples(pieces + 1);
  for (size_t i = 0; i <= pieces; ++i) {
    samples[i] =
        path.position(path.length_m() * static_cast<double>(i) / static_cast<double>(pieces));
  }
  return samples;
}

/// Smooths the kinks between lanes with a Gaussian of 1.5 m.
Polyline smoothed(const Polyline& line) {
  constexpr int kReach = 9;
  constexpr double kSigma_m = 1.5;
  std::array<double, kReach + 1> weight_at{};
  for (int k = 0; k <= kReach; ++k) {
    weight_at[static_cast<size_t>(k)] = std::exp(-0.5 * std::pow(k * kStep_m / kSigma_m, 2));
  }
  const int last = static_cast<int>(line.size()) - 1;
  Polyline result(line.size());
  for (int i = 0; i <= last; ++i) {
    // The window stays symmetric and shrinks towards the ends, so the end points do not move.
    const int reach = std::min({kReach, i, last - i});
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double weights = 0.0;
    for (int k = -reach; k <= reach; ++k) {
      const double weight = weight_at[static_cast<size_t>(std::abs(k))];
      sum += weight * line[static_cast<size_t>(i + k)];
      weights += weight;
    }
    result[static_cast<size_t>(i)] = sum / weights;
  }
  return result;
}

/// A value between two samples, and its derivative.
template <typename T>
struct Interpolated {
  T value;
  T slope;
};

/// Cubic Hermite interpolation between two values with given slopes, `length` apart.
template <typename T>
Interpolated<T> hermite(const T& a, const T& slope_a, const T& b, const T& slope_b, double length,
                        double t) {
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {.value = (2.0 * t3 - 3.0 * t2 + 1.0) * a + (t3 - 2.0 * t2 + t) * length * slope_a +
                   (3.0 * t2 - 2.0 * t3) * b + (t3 - t2) * length * slope_b,
          .slope = 6.0 * (t - t2) / length * (b - a) + (3.0 * t2 - 4.0 * t + 1.0) * slope_a +
                   (3.0 * t2 - 2.0 * t) * slope_b};
}

/// The share of the top speed for which the route is planned. It depends on the fastest lane. The
/// least share is enough for every town, so their routes depend on the seed alone.
double planned_share(const HdMap& map) {
  constexpr double kLeastShare = 0.8;
  double fastest_mps = 0.0;
  for (const Lane& lane : map.lanes) fastest_mps = std::max(fastest_mps, lane.speed_limit_mps);
  return std::clamp(fastest_mps / kTopSpeed_mps, kLeastShare, 1.0);
}

// Wavelengths of the road's height.
constexpr double kShortestSlope_m = 80.0;
constexpr double kLongestSlope_m = 400.0;

}  // namespace

Drive::Drive(const World& world, uint64_t seed, double duration_s, const StopTimes& times,
             Pace pace)
    : seed_(seed),
      duration_s_(duration_s),
      pace_(std::move(pace)),
      planned_start_s_(-pace_.earliest_planned_s(duration_s)),
      pitch_noise_(seed_for(seed, "pitch"), radians(0.27), 4.0, 40.0),
      roll_noise_(seed_for(seed, "roll"), radians(0.2), 4.0, 40.0),
      lift_noise_(seed_for(seed, "lift"), 0.012, 4.0, 40.0),
      crest_noise_(seed_for(seed, "crest"), 1.0, kShortestSlope_m, kLongestSlope_m),
      camber_noise_(seed_for(seed, "camber"), 1.0, kShortestSlope_m, kLongestSlope_m),
      twist_noise_(seed_for(seed, "twist"), 1.0, kShortestSlope_m, kLongestSlope_m) {
  assert(!world.map.lanes.empty());
  Random random(seed_for(seed, "route"));
  const double length_m = duration_s * kTopSpeed_mps * planned_share(world.map) + 50.0;
  const std::vector<uint32_t> route = random_lane_route(world.map, length_m, random);
  lay_path(world.map, route);
  measure_path();
  const std::vector<Stop> stops = choose_stops(world.map, route, times);
  plan_speed(world.map, route, stops);
  plan_time(stops);
}

void Drive::lay_path(const HdMap& map, const std::vector<uint32_t>& route) {
  Polyline line;
  for (const uint32_t lane : route) append(line, map.lanes[lane].centerline);
  const SmoothNoise wander(seed_for(seed_, "wander"), kWander_m, 50.0, 250.0);
  const Polyline samples = smoothed(resampled(line));
  lane_step_m_ = polyline_length(line) / static_cast<double>(samples.size() - 1);
  const Path centre(samples);
  Polyline wandering(samples.size());
  double station_m = 0.0;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (i > 0) station_m += (samples[i] - samples[i - 1]).norm();
    wandering[i] = centre.beside(station_m, wander.at(station_m));
  }
  points_ = smoothed(wandering);
}

void Drive::measure_path() {
  const size_t count = points_.size();
  station_m_.assign(count, 0.0);
  heading_rad_.assign(count, 0.0);
  curvature_radpm_.assign(count, 0.0);
  for (size_t i = 1; i < count; ++i) {
    station_m_[i] = station_m_[i - 1] + (points_[i] - points_[i - 1]).norm();
  }
  for (size_t i = 0; i < count; ++i) {
    const size_t before = i > 0 ? i - 1 : 0;
    const Eigen::Vector2d chord = points_[std::min(i + 1, count - 1)] - points_[before];
    const double heading = std::atan2(chord.y(), chord.x());
    heading_rad_[i] =
        i > 0 ? heading_rad_[i - 1] + wrap_angle(heading - heading_rad_[i - 1]) : heading;
  }
  for (size_t i = 1; i + 1 < count; ++i) {
    curvature_radpm_[i] =
        (heading_rad_[i + 1] - heading_rad_[i - 1]) / (station_m_[i + 1] - station_m_[i - 1]);
  }
  // At the ends the chord has only one side and would give the heading half a step away, so the
  // ends are extrapolated from their neighbours.
  const size_t last = count - 1;
  curvature_radpm_[0] = curvature_radpm_[1] = curvature_radpm_[2];
  curvature_radpm_[last] = curvature_radpm_[last - 1] = curvature_radpm_[last - 2];
  heading_rad_[0] = heading_rad_[1] - curvature_radpm_[1] * station_m_[1];
  heading_rad_[last] =
      heading_rad_[last - 1] + curvature_radpm_[last] * (station_m_[last] - station_m_[last - 1]);
}

std::vector<Drive::Stop> Drive::choose_stops(const HdMap& map, const std::vector<uint32_t>& route,
                                             const StopTimes& times) const {
  Random random(seed_for(seed_, "stops"));
  std::vector<Stop> stops;
  double end_m = 0.0;
  for (const uint32_t lane : route) {
    const double lane_m = polyline_length(map.lanes[lane].centerline);
    end_m += lane_m;
    const bool stops_here = random.chance(0.25);
    const double wait_s = random.uniform(times.shortest_s, times.longest_s);
    if (!stops_here || lane_m < 25.0 || map.lanes[lane].successors.size() < 2) continue;
    const auto sample = static_cast<size_t>((end_m - kStopBeforeLaneEnd_m) / lane_step_m_);
    if (sample + 1 < points_.size()) stops.push_back({sample, wait_s});
  }
  return stops;
}

void Drive::plan_speed(const HdMap& map, const std::vector<uint32_t>& route,
                       const std::vector<Stop>& stops) {
  const size_t count = points_.size();
  const double haste = Random(seed_for(seed_, "haste")).uniform(0.7, 1.0);
  speed_mps_.assign(count, 0.0);
  size_t on_route = 0;
  double lane_end_m = polyline_length(map.lanes[route[0]].centerline);
  for (size_t i = 0; i < count; ++i) {
    while (static_cast<double>(i) * lane_step_m_ > lane_end_m && on_route + 1 < route.size()) {
      lane_end_m += polyline_length(map.lanes[route[++on_route]].centerline);
    }
    const double limit = std::min(kTopSpeed_mps, map.lanes[route[on_route]].speed_limit_mps);
    const double bend = std::max(1e-4, std::abs(curvature_radpm_[i]));
    speed_mps_[i] = haste * std::min(limit, std::sqrt(kLateralLimit_mps2 / bend));
  }
  speed_mps_.back() = 0.0;
  for (const Stop& stop : stops) speed_mps_[stop.sample] = 0.0;
  const auto limit_step = [&](size_t from, size_t to, double rate_mps2) {
    const double step_m = std::abs(station_m_[to] - station_m_[from]);
    const double reachable = std::sqrt(std::pow(speed_mps_[from], 2) + 2.0 * rate_mps2 * step_m);
    speed_mps_[to] = std::min(speed_mps_[to], reachable);
  };
  for (size_t k = count - 1; k > 0; --k) limit_step(k, k - 1, kBraking_mps2);
  for (size_t k = 0; k + 1 < count; ++k) limit_step(k, k + 1, kAcceleration_mps2);
}

void Drive::plan_time(const std::vector<Stop>& stops) {
  const size_t count = points_.size();
  arrival_s_.assign(count, 0.0);
  departure_s_.assign(count, 0.0);
  auto stop = stops.begin();  // they are in the order of the path
  for (size_t i = 0; i < count; ++i) {
    if (i > 0) {
      const double mean_speed = 0.5 * (speed_mps_[i] + speed_mps_[i - 1]);
      arrival_s_[i] = departure_s_[i - 1] + (station_m_[i] - station_m_[i - 1]) / mean_speed;
    }
    departure_s_[i] = arrival_s_[i];
    for (; stop != stops.end() && stop->sample == i; ++stop) departure_s_[i] += stop->wait_s;
  }
}

Drive::Progress Drive::planned_at(double planned_s) const {
  // Index i is the last sample that the vehicle has reached.
  const auto after = std::upper_bound(arrival_s_.begin(), arrival_s_.end(), planned_s);
  const size_t i = static_cast<size_t>(after - arrival_s_.begin()) - 1;
  Progress progress{.sample = i};
  if (planned_s < departure_s_[i]) return progress;  // the vehicle waits
  if (i + 1 == points_.size()) {                     // the end of the route
    progress.sample = i - 1;
    progress.fraction = 1.0;
    return progress;
  }
  const double step_m = station_m_[i + 1] - station_m_[i];
  const double elapsed = planned_s - departure_s_[i];
  progress.acceleration_mps2 =
      (speed_mps_[i + 1] - speed_mps_[i]) / (arrival_s_[i + 1] - departure_s_[i]);
  progress.speed_mps = speed_mps_[i] + progress.acceleration_mps2 * elapsed;
  progress.fraction =
      (speed_mps_[i] * elapsed + 0.5 * progress.acceleration_mps2 * elapsed * elapsed) / step_m;
  return progress;
}

Drive::Progress Drive::progress_at(double time_s) const {
  const Pace::Moment moment = pace_.at(std::clamp(time_s, 0.0, duration_s_));
  Progress progress = planned_at(std::max(0.0, planned_start_s_ + moment.planned_s));
  progress.acceleration_mps2 = moment.pace * moment.pace * progress.acceleration_mps2 +
                               moment.change_per_s * progress.speed_mps;
  progress.speed_mps *= moment.pace;
  return progress;
}

Drive::State Drive::at(double time_s) const {
  const Progress now = progress_at(time_s);
  const size_t i = now.sample;
  const double step_m = station_m_[i + 1] - station_m_[i];
  const Eigen::Vector2d position = hermite(points_[i], unit_vector(heading_rad_[i]), points_[i + 1],
                                           unit_vector(heading_rad_[i + 1]), step_m, now.fraction)
                                       .value;
  // The yaw rate is the derivative of the heading, so that odometry and truth agree.
  const auto heading = hermite(heading_rad_[i], curvature_radpm_[i], heading_rad_[i + 1],
                               curvature_radpm_[i + 1], step_m, now.fraction);
  State state;
  state.map_from_vehicle = {position.x(), position.y(), wrap_angle(heading.value)};
  state.speed_mps = now.speed_mps;
  state.yaw_rate_radps = now.speed_mps * heading.slope;
  state.acceleration_mps2 = now.acceleration_mps2;
  return state;
}

double Drive::distance_at(double time_s) const {
  const Progress now = progress_at(time_s);
  return station_m_[now.sample] +
         now.fraction * (station_m_[now.sample + 1] - station_m_[now.sample]);
}

GroundShape Drive::ground_at(double time_s, const GroundShape& sigma) const {
  if (sigma.is_flat()) return {};
  const double distance_m = distance_at(time_s);
  return {.along_per_m = sigma.along_per_m * crest_noise_.at(distance_m),
          .across_per_m = sigma.across_per_m * camber_noise_.at(distance_m),
          .twist_per_m = sigma.twist_per_m * twist_noise_.at(distance_m)};
}

BodyMotion Drive::body_at(double time_s) const {
  constexpr double kPitchPerAcceleration = 0.004;  // rad per m/s^2, typical of cars
  constexpr double kRollPerAcceleration = 0.007;
  constexpr int kTaps = 5;  // the springs smooth the acceleration over 0.75 s
  double longitudinal = 0.0;
  double lateral = 0.0;
  for (int k = 0; k < kTaps; ++k) {
    const State state = at(time_s + 0.15 * (k - kTaps / 2));
    longitudinal += state.acceleration_mps2 / kTaps;
    lateral += state.speed_mps * state.yaw_rate_radps / kTaps;
  }
  const double distance_m = distance_at(time_s);
  return {.pitch_rad = pitch_noise_.at(distance_m) - kPitchPerAcceleration * longitudinal,
          .roll_rad = roll_noise_.at(distance_m) + kRollPerAcceleration * lateral,
          .lift_m = lift_noise_.at(distance_m)};
}

}  // namespace bevloc::sim
