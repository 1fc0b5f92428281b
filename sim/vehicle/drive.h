// A vehicle that drives through a world: its true pose, speed and body motion at any time.
#pragma once

#include <cstdint>
#include <vector>

#include "common/se2.h"
#include "sim/render/renderer.h"
#include "sim/vehicle/smooth_noise.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// Drives a random route along the lanes with the manners of a calm driver: lateral acceleration up
/// to 2.5 m/s^2, longitudinal from -3 to 2 m/s^2, slower in bends, now and then a stop at a
/// junction, a little wander within the lane. The whole drive follows from world, seed and
/// duration. Immutable: safe to read from several threads.
class Drive {
 public:
  /// The world's map must have lanes. Where all routes end before the duration is over, the vehicle
  /// stops at the end and stays.
  Drive(const World& world, uint64_t seed, double duration_s);

  struct State {
    Se2 map_from_vehicle;  ///< the rear axle's middle, on the ground
    double speed_mps = 0.0;
    double yaw_rate_radps = 0.0;
    double acceleration_mps2 = 0.0;  ///< along the vehicle's x axis
  };

  /// Times before the start or after the end are taken as the start or the end.
  State at(double time_s) const;
  BodyMotion body_at(double time_s) const;

  double duration_s() const { return duration_s_; }
  /// The way of the rear axle, a point about every half metre.
  const Polyline& path() const { return points_; }

 private:
  struct Stop {
    size_t sample;
    double wait_s;
  };

  void lay_path(const HdMap& map, const std::vector<uint32_t>& route);
  void measure_path();
  std::vector<Stop> choose_stops(const HdMap& map, const std::vector<uint32_t>& route) const;
  void plan_speed(const HdMap& map, const std::vector<uint32_t>& route,
                  const std::vector<Stop>& stops);
  void plan_time(const std::vector<Stop>& stops);

  /// Where the vehicle is between two samples of its path.
  struct Progress {
    size_t sample = 0;
    double fraction = 0.0;
    double speed_mps = 0.0;
    double acceleration_mps2 = 0.0;
  };
  Progress progress_at(double time_s) const;

  uint64_t seed_;
  double duration_s_;
  SmoothNoise pitch_noise_;  ///< over the way driven, as are roll and lift
  SmoothNoise roll_noise_;
  SmoothNoise lift_noise_;

  double lane_step_m_ = 0.0;  ///< from sample to sample along the lanes' own centre lines
  // Samples along the path.
  Polyline points_;
  std::vector<double> station_m_;
  std::vector<double> heading_rad_;  ///< continuous, not wrapped
  std::vector<double> curvature_radpm_;
  std::vector<double> speed_mps_;
  std::vector<double> arrival_s_;
  std::vector<double> departure_s_;  ///< later than the arrival at a stop
};

}  // namespace bevloc::sim
