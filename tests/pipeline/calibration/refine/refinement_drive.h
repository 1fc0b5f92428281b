// A simulated drive with paint around it, for tests of the refinement.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "pipeline/calibration/refine/refinement.h"
#include "tests/support/demo_rig.h"

namespace bevloc {

inline constexpr double kEverything_rad = 1.0;

/// The vehicle drives at a changing speed, straight or along a winding road.
class Drive {
 public:
  Drive(bool winding, double speed_change) : winding_(winding), speed_change_(speed_change) {
    Se2 pose;
    std::vector<ReferenceTrajectory::Pose> poses;
    for (int i = 0; i <= kSteps; ++i) {
      const double time_s = i * kStep_s;
      poses.push_back({Time{} + from_seconds(time_s), pose});
      pose = pose * arc_motion(speed_mps(time_s), rate_radps(time_s), kStep_s);
    }
    reference = ReferenceTrajectory(std::move(poses));
  }

  Time time_of(int frame) const { return Time{} + from_seconds(1.0 + 0.5 * frame); }

  /// The lateral acceleration, positive to the left.
  double lateral_mps2(int frame) const {
    const double time_s = to_seconds(time_of(frame) - Time{});
    return speed_mps(time_s) * rate_radps(time_s);
  }

  ReferenceTrajectory reference{{}};
  static constexpr int kFrames = 60;

 private:
  double speed_mps(double time_s) const { return 8.0 + speed_change_ * std::sin(0.4 * time_s); }
  double rate_radps(double time_s) const { return winding_ ? 0.35 * std::sin(0.3 * time_s) : 0.0; }

  bool winding_;
  double speed_change_;
  static constexpr double kStep_s = 0.02;
  static constexpr int kSteps = 1700;
};

inline std::optional<Eigen::Vector2d> seen(const CameraModel& camera, const Se2& map_from_vehicle,
                                           const Eigen::Vector2d& point) {
  const Eigen::Vector2d at = map_from_vehicle.inverse() * point;
  return camera.intrinsics.project(camera.vehicle_from_camera.inverse() *
                                   Eigen::Vector3d(at.x(), at.y(), 0.0));
}

/// What is simulated besides the true cameras.
struct Sight {
  double time_offset_s = 0.0;
  bool crossing = true;  ///< lines across the vehicle's path too
  double noise_px = 0.2;
  int nearly_blind = -1;  ///< the camera that sees little; -1: none
  int seen_of_blind = 0;  ///< how many sightings it has during the drive
};

/// What one true camera sees of lines along and across the vehicle's path. `camera` and `assumed`
/// say where the lines are expected.
inline std::vector<PaintSighting> look(const CameraModel& camera, const Se2& assumed,
                                       const CameraModel& truth, const Se2& exposed,
                                       const Sight& sight, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, sight.noise_px);
  std::vector<PaintSighting> sightings;
  for (double forward = -20.0; forward <= 20.0; forward += 1.0) {
    for (const double left : {-5.25, -1.75, 1.75, 5.25}) {
      for (const bool across : {false, true}) {
        if (across && (!sight.crossing || static_cast<int>(forward) % 7 != 0)) continue;
        const Eigen::Vector2d point = assumed * Eigen::Vector2d(forward, left);
        const Eigen::Vector2d along(across ? 0.0 : 1.0, across ? 1.0 : 0.0);
        const Eigen::Vector2d ahead = assumed * (Eigen::Vector2d(forward, left) + 0.05 * along);
        const auto here_px = seen(camera, assumed, point);
        const auto ahead_px = seen(camera, assumed, ahead);
        const auto true_px = seen(truth, exposed, point);
        if (!here_px || !ahead_px || !true_px) continue;
        if (here_px->x() < 0 || here_px->x() > 639 || here_px->y() < 0 || here_px->y() > 359) {
          continue;
        }
        const Eigen::Vector2d tangent = (*ahead_px - *here_px).normalized();
        PaintSighting sighting;
        sighting.point_m = point;
        sighting.predicted_px = *here_px;
        sighting.normal_px = {-tangent.y(), tangent.x()};
        sighting.pixels_per_m = 20.0;
        sighting.candidates = 1;
        sighting.offset_px[0] = sighting.normal_px.dot(*true_px - *here_px) + noise(random);
        sightings.push_back(sighting);
      }
    }
  }
  return sightings;
}

/// Adds what all cameras see during the drive.
inline void add_sightings(RefinementProblem& problem, const Rig& rig,
                          const std::function<Rig(int frame)>& truth_of, const Drive& drive,
                          const Sight& sight) {
  std::mt19937_64 random(5);
  int seen_of_blind = 0;
  for (int frame = 0; frame < Drive::kFrames; ++frame) {
    const Rig truth = truth_of(frame);
    const Time time = drive.time_of(frame);
    const Se2 exposed = *drive.reference.at(time + from_seconds(sight.time_offset_s));
    for (int c = 0; c < kCameraCount; ++c) {
      const CameraModel camera = adjusted(rig.cameras[c], problem.change(c));
      const Se2 assumed = *drive.reference.at(time + from_seconds(problem.change(c)[kTimeOffset]));
      auto sightings = look(camera, assumed, truth.cameras[c], exposed, sight, random);
      if (c == sight.nearly_blind) {
        const auto most = static_cast<size_t>(sight.seen_of_blind - seen_of_blind);
        sightings.resize(std::min(sightings.size(), most));
        seen_of_blind += static_cast<int>(sightings.size());
      }
      problem.add(frame, c, time, std::move(sightings));
    }
  }
}

}  // namespace bevloc
