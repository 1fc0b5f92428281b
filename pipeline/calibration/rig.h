// The six surround cameras and their fixed order.
#pragma once

#include <array>
#include <bitset>
#include <string_view>

#include "common/se2.h"
#include "pipeline/calibration/camera_model.h"

namespace bevloc {

inline constexpr int kCameraCount = 6;

/// The order of cameras everywhere: in framesets, in the network's input, in masks, in YAML.
inline constexpr std::array<std::string_view, kCameraCount> kCameraNames = {
    "front_left", "front", "front_right", "back_left", "back", "back_right"};

/// Bit i is camera i.
using CameraMask = std::bitset<kCameraCount>;

struct Rig {
  std::array<CameraModel, kCameraCount> cameras;
};

/// Cameras need not expose at once. For each, reference_from_exposure: the vehicle at that camera's
/// exposure, seen from the vehicle at the time that counts for all. All zero when they do.
using CameraMotions = std::array<Se2, kCameraCount>;

}  // namespace bevloc
