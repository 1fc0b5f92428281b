#include "drivers/mock/true_rig.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

Rig plain_rig() {
  Rig rig;
  for (CameraModel& camera : rig.cameras) {
    camera.intrinsics = {.width_px = 640, .height_px = 360, .fx_px = 500.0, .fy_px = 500.0};
    camera.vehicle_from_camera.translation_m = {1.0, 0.0, 1.5};
  }
  return rig;
}

double rotation_between_rad(const CameraModel& a, const CameraModel& b) {
  return Eigen::AngleAxisd(a.vehicle_from_camera.rotation.transpose() *
                           b.vehicle_from_camera.rotation)
      .angle();
}

TEST(TrueRig, WithoutErrorIsTheNominalRig) {
  const Rig nominal = plain_rig();
  const Rig rig = true_rig(nominal, {}, 3);
  for (int i = 0; i < kCameraCount; ++i) {
    EXPECT_EQ(rotation_between_rad(rig.cameras[i], nominal.cameras[i]), 0.0);
    EXPECT_EQ(rig.cameras[i].vehicle_from_camera.translation_m,
              nominal.cameras[i].vehicle_from_camera.translation_m);
    EXPECT_EQ(rig.cameras[i].intrinsics.fx_px, 500.0);
  }
}

TEST(TrueRig, ErrorsHaveTheConfiguredSigma) {
  const CalibrationError sigma{
      .rotation_rad = 0.01, .translation_m = 0.02, .relative_focal = 0.005};
  const Rig nominal = plain_rig();
  constexpr int kRigs = 400;
  double rotation = 0.0;
  double translation = 0.0;
  double focal = 0.0;
  for (uint64_t seed = 0; seed < kRigs; ++seed) {
    const Rig rig = true_rig(nominal, sigma, seed);
    for (int i = 0; i < kCameraCount; ++i) {
      const CameraModel& camera = rig.cameras[i];
      rotation += std::pow(rotation_between_rad(camera, nominal.cameras[i]), 2);
      translation += (camera.vehicle_from_camera.translation_m -
                      nominal.cameras[i].vehicle_from_camera.translation_m)
                         .squaredNorm();
      focal += std::pow(camera.intrinsics.fx_px / 500.0 - 1.0, 2);
      EXPECT_EQ(camera.intrinsics.fx_px, camera.intrinsics.fy_px);
      EXPECT_TRUE(camera.vehicle_from_camera.rotation.isUnitary(1e-9));
    }
  }
  constexpr double kCameras = kRigs * kCameraCount;
  EXPECT_NEAR(std::sqrt(rotation / kCameras / 3.0), sigma.rotation_rad, 0.0005);
  EXPECT_NEAR(std::sqrt(translation / kCameras / 3.0), sigma.translation_m, 0.001);
  EXPECT_NEAR(std::sqrt(focal / kCameras), sigma.relative_focal, 0.0003);
}

TEST(TrueRig, IsDeterminedByItsSeedAndDiffersBetweenCameras) {
  const CalibrationError sigma{.rotation_rad = 0.01};
  const Rig a = true_rig(plain_rig(), sigma, 1);
  const Rig b = true_rig(plain_rig(), sigma, 1);
  const Rig c = true_rig(plain_rig(), sigma, 2);
  EXPECT_EQ(a.cameras[0].vehicle_from_camera.rotation, b.cameras[0].vehicle_from_camera.rotation);
  EXPECT_GT(rotation_between_rad(a.cameras[0], c.cameras[0]), 1e-6);
  EXPECT_GT(rotation_between_rad(a.cameras[0], a.cameras[1]), 1e-6);
}

}  // namespace
}  // namespace bevloc::drivers
