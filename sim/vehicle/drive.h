// Simulates a drive through a world: the true pose, speed and body motion at any time.
#pragma once

#include <cstdint>
#include <vector>

#include "common/se2.h"
#include "sim/vehicle/body_motion.h"
#include "sim/vehicle/pace.h"
#include "sim/vehicle/smooth_noise.h"
#include "sim/vehicle/stance.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// The range of the time that a vehicle waits where it stops. The time is uniform.
struct StopTimes {
  double shortest_s = 2.0;
  double longest_s = 7.0;
};

/// Drives a random route along the lanes like a calm driver: lateral acceleration up to 2.5 m/s^2,
/// longitudinal acceleration from -3 to 2 m/s^2, slower in bends, occasional stops at junctions, a
/// small lateral wander within the lane. A pace can make the vehicle stand or reverse along its
/// path; its changes add to the accelerations. World, seed, duration, stops and pace determine the
/// whole drive. Immutable, and so thread-safe.
class Drive {
 public:
  /// The world's map must have lanes. If the route ends before the duration, the vehicle stops
  /// there and stays. Keeps no reference to the world.
  Drive(const World& world, uint64_t seed, double duration_s, const StopTimes& stops = {},
        Pace pace = {});

  struct State {
    Se2 map_from_vehicle;    ///< pose of the middle of the rear axle on the ground
    double speed_mps = 0.0;  ///< negative if the vehicle reverses
    double yaw_rate_radps = 0.0;
    double acceleration_mps2 = 0.0;  ///< along the vehicle's x axis
  };

  /// The time is clamped to [0, duration_s].
  State at(double time_s) const;
  /// Pitch, roll and lift of the body from accelerations and road bumps; same times as at().
  BodyMotion body_at(double time_s) const;
  /// The ground around the vehicle on a road that rises and falls; same times as at(). Along the
  /// way each curvature varies around zero, with the one in `sigma` as standard deviation.
  GroundShape ground_at(double time_s, const GroundShape& sigma) const;

  double duration_s() const { return duration_s_; }
  /// The path of the rear axle, with a point about every 0.5 m.
  const Polyline& path() const { return points_; }

 private:
  struct Stop {
    size_t sample;  ///< index of the sample of the path
    double wait_s;
  };

  void lay_path(const HdMap& map, const std::vector<uint32_t>& route);
  void measure_path();
  std::vector<Stop> choose_stops(const HdMap& map, const std::vector<uint32_t>& route,
                                 const StopTimes& times) const;
  void plan_speed(const HdMap& map, const std::vector<uint32_t>& route,
                  const std::vector<Stop>& stops);
  void plan_time(const std::vector<Stop>& stops);

  /// The vehicle's place between two samples of its path, and its motion along it.
  struct Progress {
    size_t sample = 0;
    double fraction = 0.0;  ///< share of the way from `sample` to the next one
    double speed_mps = 0.0;
    double acceleration_mps2 = 0.0;
  };
  Progress planned_at(double planned_s) const;
  Progress progress_at(double time_s) const;
  double distance_at(double time_s) const;

  uint64_t seed_;
  double duration_s_;
  Pace pace_;
  double planned_start_s_;  ///< where the drive starts in the plan, so that the vehicle can reverse
  SmoothNoise pitch_noise_;  ///< noise over the distance driven, like roll and lift
  SmoothNoise roll_noise_;
  SmoothNoise lift_noise_;
  SmoothNoise crest_noise_;  ///< noise of the ground's curvatures, with standard deviation 1
  SmoothNoise camber_noise_;
  SmoothNoise twist_noise_;

  double lane_step_m_ = 0.0;  ///< distance of two samples along the lanes' centre lines
  // Samples along the path.
  Polyline points_;
  std::vector<double> station_m_;
  std::vector<double> heading_rad_;  ///< continuous, not wrapped
  std::vector<double> curvature_radpm_;
  std::vector<double> speed_mps_;
  std::vector<double> arrival_s_;
  std::vector<double> departure_s_;  ///< equals the arrival except at stops
};

}  // namespace bevloc::sim
