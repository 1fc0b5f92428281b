// The changes of a camera that refine_rig() estimates.
#pragma once

#include <array>
#include <string_view>

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/calibration/camera_model.h"

namespace bevloc {

/// Rotation vector about the camera's axes (pitch about x, yaw about y, roll about z), translation
/// along the vehicle's axes, relative change of both focal lengths, and the time offset, by which a
/// picture was taken later than its time stamp says.
enum CameraParameter : int {
  kPitch = 0,
  kYaw = 1,
  kRoll = 2,
  kForward = 3,
  kLeft = 4,
  kUp = 5,
  kFocal = 6,
  kTimeOffset = 7,
};
inline constexpr int kCameraParameters = 8;

struct CameraParameterInfo {
  std::string_view name;
  std::string_view key;   ///< in JSON, with the unit
  double per_unit;        ///< SI units (rad, m, 1, s) in one unit that people read
  double expected_error;  ///< one sigma before a recording, in SI units
};
inline constexpr double kPerDegree = radians(1.0);
inline constexpr std::array<CameraParameterInfo, kCameraParameters> kCameraParameterInfos{{
    {"pitch", "pitch_deg", kPerDegree, 1.0 * kPerDegree},
    {"yaw", "yaw_deg", kPerDegree, 1.0 * kPerDegree},
    {"roll", "roll_deg", kPerDegree, 1.0 * kPerDegree},
    {"forward", "forward_m", 1.0, 0.1},
    {"left", "left_m", 1.0, 0.1},
    {"up", "up_m", 1.0, 0.1},
    {"focal length", "focal_percent", 0.01, 0.02},
    {"time offset", "time_offset_ms", 0.001, 0.03},
}};

using CameraAdjustment = Eigen::Matrix<double, kCameraParameters, 1>;

/// The camera with rotation, translation and focal length changed.
CameraModel adjusted(const CameraModel& camera, const CameraAdjustment& by);

}  // namespace bevloc
