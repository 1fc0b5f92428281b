#include "sim/sim_rig.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "common/se2.h"

namespace bevloc::sim {
namespace {

TEST(NominalRig, LooksAllAroundInTheFixedOrder) {
  const Rig rig = nominal_rig();
  const std::array<double, kCameraCount> azimuths_deg = {55.2, 0.3, -56.4, 108.6, 179.9, -110.8};
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    const Eigen::Matrix3d& rotation = rig.cameras[i].vehicle_from_camera.rotation;
    EXPECT_TRUE((rotation.transpose() * rotation).isIdentity(1e-12));
    EXPECT_NEAR(rotation.determinant(), 1.0, 1e-12);
    const Eigen::Vector3d forward = rotation.col(2);
    EXPECT_NEAR(degrees(std::atan2(forward.y(), forward.x())), azimuths_deg[i], 1e-9)
        << kCameraNames[i];
    EXPECT_LE(forward.z(), 0.0) << "level or a little down";
    EXPECT_GE(forward.z(), std::sin(radians(-2.0)));
    EXPECT_NEAR(rotation(2, 0), 0.0, 1e-12) << "no roll";
    EXPECT_LT(rotation(2, 1), -0.99) << "y points down";
  }
}

TEST(NominalRig, HasTheFieldsOfViewOfTheRealRig) {
  const Rig rig = nominal_rig();
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    const Intrinsics& camera = rig.cameras[i].intrinsics;
    const Eigen::Vector3d left = camera.ray({-0.5, camera.cy_px});
    const Eigen::Vector3d right = camera.ray({camera.width_px - 0.5, camera.cy_px});
    const double angle_deg = degrees(std::acos(left.normalized().dot(right.normalized())));
    EXPECT_NEAR(angle_deg, kCameraNames[i] == "back" ? 93.0 : 65.5, 3.0) << kCameraNames[i];
  }
}

TEST(NominalRig, CoversEveryDirectionOnTheGround) {
  const Rig rig = nominal_rig();
  for (int step = 0; step < 360; ++step) {
    const double azimuth_rad = radians(step);
    const Eigen::Vector3d point(20.0 * std::cos(azimuth_rad), 20.0 * std::sin(azimuth_rad), 0.0);
    bool seen = false;
    for (const CameraModel& camera : rig.cameras) {
      const auto pixel = camera.intrinsics.project(camera.vehicle_from_camera.inverse() * point);
      seen = seen || (pixel && pixel->x() >= 0.0 && pixel->x() < camera.intrinsics.width_px &&
                      pixel->y() >= 0.0 && pixel->y() < camera.intrinsics.height_px);
    }
    EXPECT_TRUE(seen) << step << " degrees";
  }
}

}  // namespace
}  // namespace bevloc::sim
