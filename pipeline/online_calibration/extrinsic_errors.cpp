#include "pipeline/online_calibration/extrinsic_errors.h"

#include <Eigen/Geometry>

namespace bevloc {

Se3 with_errors(const Se3& vehicle_from_camera,
                const Eigen::Matrix<double, kErrorsPerCamera, 1>& errors) {
  Se3 result = vehicle_from_camera;
  const Eigen::Vector3d rotation = errors.head<3>();
  if (rotation.norm() > 0.0) result.rotation *= rotation_by(rotation);
  result.translation_m += errors.tail<3>();
  return result;
}

void apply_errors(const ExtrinsicErrors& errors, Rig& rig) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    Se3& extrinsics = rig.cameras[camera].vehicle_from_camera;
    extrinsics =
        with_errors(extrinsics, errors.segment<kErrorsPerCamera>(camera * kErrorsPerCamera));
  }
}

GroundShift ground_shift(const Se3& vehicle_from_camera, double x_m, double y_m) {
  const Eigen::Vector3d& camera_m = vehicle_from_camera.translation_m;
  const Eigen::Vector3d ray = Eigen::Vector3d(x_m, y_m, 0.0) - camera_m;
  GroundShift shift;
  for (int axis = 0; axis < 3; ++axis) {
    // If the end of a ray is lifted by z, the ray meets the ground farther away: it grows by the
    // share z / height.
    const Eigen::Vector3d turned = vehicle_from_camera.rotation.col(axis).cross(ray);
    shift.col(axis) = turned.head<2>() + ray.head<2>() * (turned.z() / camera_m.z());
  }
  shift.col(3) = Eigen::Vector2d::UnitX();
  shift.col(4) = Eigen::Vector2d::UnitY();
  shift.col(5) = ray.head<2>() / camera_m.z();
  return shift;
}

}  // namespace bevloc
