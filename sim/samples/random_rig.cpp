#include "sim/samples/random_rig.h"

#include <cmath>

#include <Eigen/Geometry>

#include "common/se2.h"
#include "sim/random.h"
#include "sim/sim_rig.h"

namespace bevloc::sim {
namespace {

constexpr double kLowest_m = 0.6;
constexpr double kHighest_m = 2.6;
constexpr double kMostDown_rad = radians(15.0);
constexpr double kMostUp_rad = radians(5.0);
constexpr double kNarrowest_rad = radians(50.0);
constexpr double kWidest_rad = radians(120.0);
// How the cameras of one vehicle differ.
constexpr double kAside_rad = radians(8.0);
constexpr double kOwnPitch_rad = radians(2.0);
constexpr double kOwnHeight_m = 0.15;
constexpr double kOwnView = 0.06;
constexpr double kForward_m = 1.5;  ///< range from the middle of the roof towards the bumper
constexpr double kOutward_m = 0.4;

/// What the cameras of a vehicle have in common.
struct Common {
  double height_m;
  double down_rad;
  double view_rad;
  double reach;  ///< 0 at the middle of the roof, 1 at the outline of the vehicle
};

double view_of(const Intrinsics& intrinsics) {
  return 2.0 * std::atan(0.5 * intrinsics.width_px / intrinsics.fx_px);
}

void move_camera(const Common& common, double variety, Random& random, CameraModel& camera) {
  const auto own = [&](double limit) { return variety * random.uniform(-limit, limit); };
  Eigen::Vector3d& place = camera.vehicle_from_camera.translation_m;
  const double outwards = common.reach - 0.5;
  const double forwards = camera.vehicle_from_camera.rotation(0, 2);
  place.x() += variety * kForward_m * outwards * forwards + own(0.2);
  place.y() += variety * kOutward_m * outwards * camera.vehicle_from_camera.rotation(1, 2);
  place.z() = std::lerp(place.z(), common.height_m, variety) + own(kOwnHeight_m);

  // The camera turns about its own axes. Its x axis points to its right, so a positive turn raises
  // its view.
  const double up_rad = -variety * common.down_rad + own(kOwnPitch_rad);
  const Eigen::Matrix3d aside =
      Eigen::AngleAxisd(own(kAside_rad), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  camera.vehicle_from_camera.rotation =
      aside * camera.vehicle_from_camera.rotation *
      Eigen::AngleAxisd(up_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();

  const double nominal_rad = view_of(camera.intrinsics);
  const double view_rad = std::lerp(nominal_rad, common.view_rad, variety) * (1.0 + own(kOwnView));
  camera.intrinsics.fx_px = 0.5 * camera.intrinsics.width_px / std::tan(0.5 * view_rad);
  camera.intrinsics.fy_px = camera.intrinsics.fx_px;
}

}  // namespace

Rig random_rig(double variety, uint64_t seed) {
  Rig rig = nominal_rig();
  if (variety <= 0.0) return rig;
  Random random(seed_for(seed, "rig"));
  const Common common{.height_m = random.uniform(kLowest_m, kHighest_m),
                      .down_rad = random.uniform(-kMostUp_rad, kMostDown_rad),
                      .view_rad = random.uniform(kNarrowest_rad, kWidest_rad),
                      .reach = random.uniform()};
  for (CameraModel& camera : rig.cameras) move_camera(common, variety, random, camera);
  return rig;
}

}  // namespace bevloc::sim
