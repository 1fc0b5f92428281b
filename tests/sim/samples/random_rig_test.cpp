#include "sim/samples/random_rig.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "common/se2.h"
#include "pipeline/preprocessing/network_camera.h"
#include "pipeline/preprocessing/view_check.h"
#include "sim/sim_rig.h"

namespace bevloc::sim {
namespace {

constexpr uint64_t kRigs = 200;

double view_deg(const CameraModel& camera) {
  const Intrinsics& intrinsics = camera.intrinsics;
  return degrees(2.0 * std::atan(0.5 * intrinsics.width_px / intrinsics.fx_px));
}

/// The angle of the camera below the horizontal plane.
double down_deg(const CameraModel& camera) {
  return degrees(std::asin(-camera.vehicle_from_camera.rotation(2, 2)));
}

TEST(RandomRig, WithoutVarietyItIsTheSimulatorsOwn) {
  const Rig rig = random_rig(0.0, 3);
  for (int i = 0; i < kCameraCount; ++i) {
    EXPECT_EQ(rig.cameras[i].vehicle_from_camera.translation_m,
              nominal_rig().cameras[i].vehicle_from_camera.translation_m);
    EXPECT_EQ(rig.cameras[i].intrinsics.fx_px, nominal_rig().cameras[i].intrinsics.fx_px);
  }
}

TEST(RandomRig, CoversTheRangesOfRealVehicles) {
  double lowest_m = 10.0;
  double highest_m = 0.0;
  double narrowest_deg = 180.0;
  double widest_deg = 0.0;
  for (uint64_t seed = 0; seed < kRigs; ++seed) {
    for (const CameraModel& camera : random_rig(1.0, seed).cameras) {
      const double height_m = camera.vehicle_from_camera.translation_m.z();
      lowest_m = std::min(lowest_m, height_m);
      highest_m = std::max(highest_m, height_m);
      narrowest_deg = std::min(narrowest_deg, view_deg(camera));
      widest_deg = std::max(widest_deg, view_deg(camera));
      EXPECT_GT(height_m, 0.4);
      EXPECT_LT(height_m, 2.8);
      EXPECT_GT(down_deg(camera), -8.5);
      EXPECT_LT(down_deg(camera), 18.5);
      const Eigen::Matrix3d& rotation = camera.vehicle_from_camera.rotation;
      EXPECT_NEAR(rotation.determinant(), 1.0, 1e-9);
      EXPECT_LT(std::abs(rotation(2, 0)), 0.03) << "cameras do not lean to the side";
    }
  }
  EXPECT_LT(lowest_m, 0.65);
  EXPECT_GT(highest_m, 2.55);
  EXPECT_LT(narrowest_deg, 52.0);
  EXPECT_GT(widest_deg, 118.0);
}

TEST(RandomRig, CamerasKeepTheirSideOfTheVehicle) {
  for (uint64_t seed = 0; seed < kRigs; ++seed) {
    const Rig rig = random_rig(1.0, seed);
    for (int i = 0; i < kCameraCount; ++i) {
      const Eigen::Vector3d view = rig.cameras[i].vehicle_from_camera.rotation.col(2);
      const Eigen::Vector3d own = nominal_rig().cameras[i].vehicle_from_camera.rotation.col(2);
      EXPECT_GT(view.head<2>().normalized().dot(own.head<2>().normalized()),
                std::cos(radians(8.5)));
    }
  }
}

TEST(RandomRig, EachCameraShowsEnoughForTheNetwork) {
  for (uint64_t seed = 0; seed < kRigs / 4; ++seed) {
    const auto checked = check_views(random_rig(1.0, seed), "rig.yaml");
    EXPECT_TRUE(checked) << checked.error().message;
  }
}

TEST(RandomRig, TheNetworkSeesTheHorizonOfEachCamera) {
  for (uint64_t seed = 0; seed < kRigs; ++seed) {
    for (const CameraModel& camera : network_rig(random_rig(1.0, seed)).cameras) {
      // A far point straight ahead of the camera, at its own height.
      Eigen::Vector3d ahead = camera.vehicle_from_camera.rotation.col(2);
      ahead.z() = 0.0;
      const auto pixel =
          camera.intrinsics.project(camera.vehicle_from_camera.rotation.transpose() * ahead);
      ASSERT_TRUE(pixel.has_value());
      EXPECT_NEAR(pixel->y(), kNetworkHorizonRow, 1.5);
    }
  }
}

}  // namespace
}  // namespace bevloc::sim
