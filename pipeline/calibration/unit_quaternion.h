// Makes rotations of the quaternions in files.
#pragma once

#include <cmath>
#include <span>

#include <Eigen/Geometry>

#include "common/result.h"

namespace bevloc {

/// The rotation of a quaternion w, x, y, z whose norm is within 0.001 of 1. The error says only
/// what was found; the caller adds the place.
inline Result<Eigen::Matrix3d> rotation_from_quaternion(std::span<const double> wxyz) {
  constexpr double kTolerance = 1e-3;
  const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(std::abs(rotation.norm() - 1.0) <= kTolerance)) {
    return fail("a quaternion of norm {:.6g}", rotation.norm());
  }
  return rotation.normalized().toRotationMatrix();
}

}  // namespace bevloc
