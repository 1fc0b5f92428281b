#include "pipeline/online_calibration/extrinsic_errors.h"

#include <gtest/gtest.h>

#include "tests/pipeline/online_calibration/demo_cells.h"

namespace bevloc {
namespace {

/// Where the ray that shows `point` with the extrinsics of `before` meets the ground with `after`.
Eigen::Vector2d seen_again(const Se3& before, const Se3& after, const Eigen::Vector2d& point) {
  const Eigen::Vector3d in_camera = before.inverse() * Eigen::Vector3d(point.x(), point.y(), 0.0);
  const Eigen::Vector3d ray = after.rotation * in_camera;
  const Eigen::Vector3d ground = after.translation_m - ray * (after.translation_m.z() / ray.z());
  return ground.head<2>();
}

TEST(ExtrinsicErrors, GroundShiftIsTheDerivativeOfWhereARayMeetsTheGround) {
  const Rig rig = demo_network_rig();
  constexpr double kSmall = 1e-6;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const Se3& extrinsics = rig.cameras[camera].vehicle_from_camera;
    // A point 8 m ahead of the camera.
    const Eigen::Vector2d ahead = extrinsics.rotation.col(2).head<2>().normalized();
    const Eigen::Vector2d point =
        extrinsics.translation_m.head<2>() + 8.0 * ahead + Eigen::Vector2d(1.0, -0.5);
    const GroundShift shift = ground_shift(extrinsics, point.x(), point.y());
    for (int axis = 0; axis < kErrorsPerCamera; ++axis) {
      Eigen::Matrix<double, kErrorsPerCamera, 1> errors;
      errors.setZero();
      errors(axis) = kSmall;
      const Eigen::Vector2d moved =
          (seen_again(extrinsics, with_errors(extrinsics, errors), point) - point) / kSmall;
      EXPECT_LT((moved - shift.col(axis)).norm(), 1e-3 * (1.0 + moved.norm()))
          << kCameraNames[camera] << ", axis " << axis;
    }
  }
}

TEST(ExtrinsicErrors, AreAppliedToTheirOwnCameraOnly) {
  const Rig before = demo_network_rig();
  Rig after = before;
  apply_errors(error_of(2, 1, radians(1.0)), after);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const Eigen::Matrix3d turn = before.cameras[camera].vehicle_from_camera.rotation.transpose() *
                                 after.cameras[camera].vehicle_from_camera.rotation;
    const double angle_rad = std::acos(std::min(1.0, 0.5 * (turn.trace() - 1.0)));
    EXPECT_NEAR(angle_rad, camera == 2 ? radians(1.0) : 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace bevloc
