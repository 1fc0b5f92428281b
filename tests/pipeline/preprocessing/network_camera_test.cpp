#include "pipeline/preprocessing/network_camera.h"

#include <gtest/gtest.h>

#include "tests/pipeline/preprocessing/surround_rig.h"

namespace bevloc {
namespace {

using test::camera_at;

constexpr double kFieldOfViewRad = radians(65.0);

TEST(NetworkCamera, IsAnUndistortedPinholeOfTheNetworkSize) {
  const CameraModel network = network_camera(camera_at(1.5, 0.0, 1.5, 0.0, kFieldOfViewRad));
  EXPECT_EQ(network.intrinsics.width_px, kNetworkWidthPx);
  EXPECT_EQ(network.intrinsics.height_px, kNetworkHeightPx);
  EXPECT_EQ(network.intrinsics.fx_px, network.intrinsics.fy_px);
  EXPECT_EQ(network.intrinsics.k1, 0.0);
  EXPECT_EQ(network.intrinsics.k2, 0.0);
  EXPECT_EQ(network.intrinsics.p1, 0.0);
  EXPECT_EQ(network.intrinsics.p2, 0.0);
}

TEST(NetworkCamera, KeepsTheExtrinsics) {
  const CameraModel real = camera_at(1.04, 0.48, 1.56, 1.9, kFieldOfViewRad, 0.1);
  const CameraModel network = network_camera(real);
  EXPECT_EQ(network.vehicle_from_camera.rotation, real.vehicle_from_camera.rotation);
  EXPECT_EQ(network.vehicle_from_camera.translation_m, real.vehicle_from_camera.translation_m);
}

TEST(NetworkCamera, ScalesTheFullWidthFromEdgeToEdge) {
  CameraModel real = camera_at(1.5, 0.0, 1.5, 0.0, kFieldOfViewRad);
  real.intrinsics.k1 = real.intrinsics.k2 = real.intrinsics.p1 = real.intrinsics.p2 = 0.0;
  const CameraModel network = network_camera(real);
  const Eigen::Vector3d left_edge = real.intrinsics.ray({-0.5, real.intrinsics.cy_px});
  const Eigen::Vector3d right_edge = real.intrinsics.ray({639.5, real.intrinsics.cy_px});
  EXPECT_NEAR(network.intrinsics.project(left_edge)->x(), -0.5, 1e-9);
  EXPECT_NEAR(network.intrinsics.project(right_edge)->x(), kNetworkWidthPx - 0.5, 1e-9);
}

TEST(NetworkCamera, ShowsTheMiddle90DegreesOfAWiderLens) {
  CameraModel real = camera_at(1.5, 0.0, 1.5, 0.0, radians(120.0));
  for (const Lens lens : {Lens::kPinhole, Lens::kFisheye}) {
    real.intrinsics.lens = lens;
    real.intrinsics.cx_px = 0.5 * (real.intrinsics.width_px - 1);
    const Intrinsics network = network_camera(real).intrinsics;
    EXPECT_EQ(network.fx_px, kLeastNetworkFocalPx);
    EXPECT_NEAR(network.project({-1.0, 0.0, 1.0})->x(), -0.5, 1e-9);
    EXPECT_NEAR(network.project({1.0, 0.0, 1.0})->x(), kNetworkWidthPx - 0.5, 1e-9);
  }
}

TEST(NetworkCamera, CutsAWiderLensAlikeOnBothSidesOfItsImage) {
  CameraModel real = camera_at(1.5, 0.0, 1.5, 0.0, radians(120.0));
  real.intrinsics.cx_px = 0.5 * (real.intrinsics.width_px - 1) + 10.0;
  const double reduction = real_pixels_per_network_pixel(real.intrinsics);
  EXPECT_NEAR(network_camera(real).intrinsics.cx_px, 0.5 * (kNetworkWidthPx - 1) + 10.0 / reduction,
              1e-9);
}

TEST(NetworkCamera, PutsTheHorizonAtTheSameRowForAnyPitch) {
  for (const double pitch_down_rad : {-0.1, 0.0, 0.2}) {
    for (const double azimuth_rad : {0.0, 1.0, 3.1}) {
      const CameraModel network =
          network_camera(camera_at(0.0, 0.0, 1.5, azimuth_rad, kFieldOfViewRad, pitch_down_rad));
      const Eigen::Vector3d level(std::cos(azimuth_rad), std::sin(azimuth_rad), 0.0);
      const Eigen::Vector3d level_camera = network.vehicle_from_camera.rotation.transpose() * level;
      EXPECT_NEAR(network.intrinsics.project(level_camera)->y(), kNetworkHorizonRow, 1e-9);
    }
  }
}

TEST(NetworkCamera, PutsTheHorizonAtThePrincipalColumnOfARolledCamera) {
  CameraModel real = camera_at(0.0, 0.0, 1.5, 0.0, kFieldOfViewRad, 0.05);
  real.vehicle_from_camera.rotation =
      real.vehicle_from_camera.rotation *
      Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const CameraModel network = network_camera(real);
  const Eigen::Vector3d ray_camera =
      network.intrinsics.ray({network.intrinsics.cx_px, kNetworkHorizonRow});
  EXPECT_NEAR((network.vehicle_from_camera.rotation * ray_camera).z(), 0.0, 1e-12);
}

TEST(NetworkCamera, NetworkRigConvertsEachCamera) {
  const Rig real = test::surround_rig();
  const Rig network = network_rig(real);
  for (int i = 0; i < kCameraCount; ++i) {
    EXPECT_EQ(network.cameras[i].intrinsics.fx_px,
              network_camera(real.cameras[i]).intrinsics.fx_px);
    EXPECT_EQ(network.cameras[i].vehicle_from_camera.translation_m,
              real.cameras[i].vehicle_from_camera.translation_m);
  }
}

}  // namespace
}  // namespace bevloc
