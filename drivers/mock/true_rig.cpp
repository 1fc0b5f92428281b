#include "drivers/mock/true_rig.h"

#include "sim/random.h"

namespace bevloc::drivers {
namespace {

Eigen::Vector3d normal_vector(sim::Random& random, double sigma) {
  const double x = random.normal(0.0, sigma);
  const double y = random.normal(0.0, sigma);
  const double z = random.normal(0.0, sigma);
  return {x, y, z};
}

}  // namespace

Rig true_rig(const Rig& nominal, const CalibrationError& sigma, uint64_t seed) {
  Rig rig = nominal;
  for (int i = 0; i < kCameraCount; ++i) {
    sim::Random random(sim::seed_for(seed, kCameraNames[i]));
    CameraModel& camera = rig.cameras[i];
    const Eigen::Vector3d rotation = normal_vector(random, sigma.rotation_rad);
    if (rotation.norm() > 0.0) camera.vehicle_from_camera.rotation *= rotation_by(rotation);
    camera.vehicle_from_camera.translation_m += normal_vector(random, sigma.translation_m);
    const double focal_scale = 1.0 + random.normal(0.0, sigma.relative_focal);
    camera.intrinsics.fx_px *= focal_scale;
    camera.intrinsics.fy_px *= focal_scale;
  }
  return rig;
}

}  // namespace bevloc::drivers
