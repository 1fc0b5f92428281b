// The errors of the cameras' extrinsics as one vector, and how they show on the ground.
#pragma once

#include <array>

#include <Eigen/Core>

#include "pipeline/calibration/rig.h"

namespace bevloc {

/// Errors per camera: three rotations about the camera's own axes (x: pitch, y: yaw, z: roll; rad),
/// then the translation along the vehicle's axes (m).
inline constexpr int kErrorsPerCamera = 6;
inline constexpr int kExtrinsicErrors = kErrorsPerCamera * kCameraCount;

/// Camera c has the elements from c * kErrorsPerCamera on. The true extrinsics are those of the rig
/// with these errors applied (with_errors()).
using ExtrinsicErrors = Eigen::Matrix<double, kExtrinsicErrors, 1>;
using ExtrinsicCovariance = Eigen::Matrix<double, kExtrinsicErrors, kExtrinsicErrors>;

/// `vehicle_from_camera` turned and moved by the errors of one camera.
Se3 with_errors(const Se3& vehicle_from_camera,
                const Eigen::Matrix<double, kErrorsPerCamera, 1>& errors);

/// Applies the errors to all six cameras of `rig`.
void apply_errors(const ExtrinsicErrors& errors, Rig& rig);

using GroundShift = Eigen::Matrix<double, 2, kErrorsPerCamera>;

/// How the point of the ground that a pixel shows moves per unit of each error, in the vehicle
/// frame. The pixel is the one that shows (x_m, y_m) without errors. The camera must be above the
/// ground.
GroundShift ground_shift(const Se3& vehicle_from_camera, double x_m, double y_m);

}  // namespace bevloc
