#include "pipeline/calibration/camera_model.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pipeline/calibration/folding_fisheye.h"
#include "tests/support/pose_matchers.h"

namespace bevloc {
namespace {

Intrinsics wide_camera() {
  Intrinsics camera;
  camera.width_px = 640;
  camera.height_px = 360;
  camera.fx_px = 500.0;
  camera.fy_px = 505.0;
  camera.cx_px = 322.3;
  camera.cy_px = 177.1;
  camera.k1 = -0.28;
  camera.k2 = 0.06;
  camera.p1 = 0.0007;
  camera.p2 = -0.0004;
  return camera;
}

void expect_ray_inverts_project(const Intrinsics& camera) {
  for (int v = -10; v <= camera.height_px + 10; v += 19) {
    for (int u = -10; u <= camera.width_px + 10; u += 19) {
      const Eigen::Vector2d pixel(u, v);
      const Eigen::Vector3d ray = camera.ray(pixel);
      EXPECT_EQ(ray.z(), 1.0);
      const auto again = camera.project(7.0 * ray);
      ASSERT_TRUE(again.has_value()) << u << " " << v;
      EXPECT_LT((*again - pixel).norm(), 1e-9 * camera.fx_px) << u << " " << v;
    }
  }
}

TEST(CameraModel, RayIsTheInverseOfProject) {
  expect_ray_inverts_project(wide_camera());
}

TEST(CameraModel, RayIsTheInverseOfProjectWithPincushionDistortion) {
  Intrinsics camera = wide_camera();
  camera.k1 = 0.35;
  camera.k2 = 0.1;
  expect_ray_inverts_project(camera);
}

TEST(CameraModel, RayIsTheInverseOfProjectWithoutDistortion) {
  Intrinsics camera = wide_camera();
  camera.k1 = camera.k2 = camera.p1 = camera.p2 = 0.0;
  expect_ray_inverts_project(camera);
  const Eigen::Vector3d ray = camera.ray({camera.cx_px + camera.fx_px, camera.cy_px});
  EXPECT_LT((ray - Eigen::Vector3d(1, 0, 1)).norm(), 1e-12);
}

Intrinsics fisheye() {
  return {.lens = Lens::kFisheye,
          .width_px = 1280,
          .height_px = 800,
          .fx_px = 407.0,
          .fy_px = 409.0,
          .cx_px = 640.3,
          .cy_px = 398.1,
          .k1 = -0.02,
          .k2 = 0.003,
          .k3 = 2e-4,
          .k4 = -1e-5};
}

TEST(CameraModel, ProjectsAFisheyeByTheOpenCvFormula) {
  const Intrinsics camera = fisheye();
  const double angle = std::atan2(5.0, 2.0);  // of the point (3, -4, 2)
  const double s = angle * angle;
  const double distorted =
      angle * (1.0 - 0.02 * s + 0.003 * s * s + 2e-4 * s * s * s - 1e-5 * s * s * s * s);
  const auto pixel = camera.project({3.0, -4.0, 2.0});
  ASSERT_TRUE(pixel.has_value());
  EXPECT_NEAR(pixel->x(), 640.3 + 407.0 * 0.6 * distorted, 1e-9);
  EXPECT_NEAR(pixel->y(), 398.1 - 409.0 * 0.8 * distorted, 1e-9);
  EXPECT_EQ(*camera.project({0.0, 0.0, 1.0}), Eigen::Vector2d(640.3, 398.1));
}

const Intrinsics kFoldingFisheye = test::folding_fisheye();

TEST(CameraModel, TheRayOfAFisheyeThatFoldsOutsideOfTheImageIsTheInverseOfProject) {
  for (int col = 0; col < kFoldingFisheye.width_px; ++col) {
    for (const int row : {0, 124, 259}) {
      const Eigen::Vector2d pixel(col, row);
      const auto again = kFoldingFisheye.project(kFoldingFisheye.ray(pixel));
      ASSERT_TRUE(again) << pixel.transpose();
      EXPECT_LT((*again - pixel).norm(), 1e-6) << pixel.transpose();
    }
  }
}

TEST(CameraModel, APixelBeyondTheFoldOfAFisheyeGetsTheWidestRayThatComesBack) {
  for (const double col : {420.0, 500.0, 2000.0}) {
    const Eigen::Vector3d ray = kFoldingFisheye.ray({col, kFoldingFisheye.cy_px});
    EXPECT_NEAR(std::atan(ray.x()), 72.0 * std::numbers::pi / 180.0, 0.02) << col;
  }
}

TEST(CameraModel, TheRayOfAFisheyeIsTheInverseOfProjectUpToTheWidestAngle) {
  const Intrinsics camera = fisheye();
  int used = 0;
  for (int v = 0; v < camera.height_px; v += 23) {
    for (int u = 0; u < camera.width_px; u += 23) {
      const Eigen::Vector2d pixel(u, v);
      const Eigen::Vector3d ray = camera.ray(pixel);
      EXPECT_EQ(ray.z(), 1.0);
      EXPECT_LE(std::atan(ray.head<2>().norm()), Intrinsics::kWidestFisheye_rad + 1e-9);
      if (std::atan(ray.head<2>().norm()) > Intrinsics::kWidestFisheye_rad - 1e-6) continue;
      const auto again = camera.project(3.0 * ray);
      ASSERT_TRUE(again.has_value()) << u << " " << v;
      EXPECT_LT((*again - pixel).norm(), 1e-6) << u << " " << v;
      ++used;
    }
  }
  EXPECT_GT(used, 1000);
  const double beyond = Intrinsics::kWidestFisheye_rad + 0.01;
  EXPECT_FALSE(camera.project({std::sin(beyond), 0.0, std::cos(beyond)}).has_value());
}

TEST(CameraModel, ResizingKeepsTheRaysAndTheOwnBody) {
  CameraModel camera{wide_camera(), {}, {{0.0, 359.0}, {320.0, 300.0}, {639.0, 359.0}}};
  const CameraModel half = resized(camera, 320, 180);
  const Eigen::Vector2d pixel(411.5, 300.5);
  const Eigen::Vector2d in_half = (pixel.array() + 0.5) / 2.0 - 0.5;
  EXPECT_LT((half.intrinsics.ray(in_half) - camera.intrinsics.ray(pixel)).norm(), 1e-12);
  for (const double row : {290.0, 340.0}) {
    const Eigen::Vector2d place(320.0, row);
    EXPECT_EQ(camera.shows_own_body(place), row > 300.0);
    EXPECT_EQ(half.shows_own_body((place.array() + 0.5) / 2.0 - 0.5), row > 300.0);
  }
}

TEST(CameraModel, ProjectsByTheOpenCvFormula) {
  const Intrinsics camera = wide_camera();
  // The documented formula with x = 0.4, y = -0.2, so r^2 = 0.2.
  const double radial = 1.0 - 0.28 * 0.2 + 0.06 * 0.04;
  const double x = 0.4 * radial + 2 * 0.0007 * 0.4 * -0.2 + -0.0004 * (0.2 + 2 * 0.16);
  const double y = -0.2 * radial + 0.0007 * (0.2 + 2 * 0.04) + 2 * -0.0004 * 0.4 * -0.2;
  const auto pixel = camera.project({2.0, -1.0, 5.0});
  ASSERT_TRUE(pixel.has_value());
  EXPECT_NEAR(pixel->x(), 500.0 * x + 322.3, 1e-9);
  EXPECT_NEAR(pixel->y(), 505.0 * y + 177.1, 1e-9);
}

TEST(CameraModel, PointsThatAreNotInFrontHaveNoPixel) {
  const Intrinsics camera = wide_camera();
  EXPECT_FALSE(camera.project({0.0, 0.0, 0.0}).has_value());
  EXPECT_FALSE(camera.project({1.0, 1.0, -3.0}).has_value());
  EXPECT_FALSE(camera.project({0.0, 0.0, std::nan("")}).has_value());
}

TEST(CameraModel, NoPixelBeyondTheMonotonicRadius) {
  Intrinsics camera = wide_camera();
  camera.k1 = -0.3;
  camera.k2 = camera.p1 = camera.p2 = 0.0;
  const double limit = std::sqrt(1.0 / 0.9);
  EXPECT_TRUE(camera.project({0.99 * limit, 0.0, 1.0}).has_value());
  EXPECT_FALSE(camera.project({1.01 * limit, 0.0, 1.0}).has_value());
  // With k2 > 0 the polynomial increases again far outside. Points there still have no pixel.
  camera.k2 = 0.01;
  EXPECT_FALSE(camera.project({30.0, 0.0, 1.0}).has_value());
}

TEST(CameraModel, APixelThatNoRayReachesGetsAFiniteRayInItsDirection) {
  Intrinsics camera = wide_camera();
  camera.k1 = -0.3;
  camera.k2 = camera.p1 = camera.p2 = 0.0;
  const Eigen::Vector3d ray = camera.ray({5000.0, camera.cy_px});
  EXPECT_TRUE(ray.allFinite());
  EXPECT_GT(ray.x(), 0.5);
  EXPECT_NEAR(ray.y(), 0.0, 1e-12);
}

TEST(Se3, InverseReversesTheTransform) {
  Se3 transform;
  transform.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  transform.translation_m = {1.5, -0.3, 1.4};
  const Eigen::Vector3d point(0.3, -2.0, 8.0);
  EXPECT_LT((transform.inverse() * (transform * point) - point).norm(), 1e-12);
  EXPECT_THAT(transform.inverse() * transform, test::RigidTransformNear({}, 1e-13, 1e-13));
}

}  // namespace
}  // namespace bevloc
