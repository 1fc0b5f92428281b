// Checks whether a rig can be that of a vehicle: finds mistakes that no number shows by itself.
#pragma once

#include <optional>
#include <string>

#include "pipeline/calibration/rig.h"

namespace bevloc {

struct RigMistake {
  int camera = 0;            ///< index into kCameraNames
  bool is_mounting = false;  ///< the key is one of vehicle_from_camera, not of the camera itself
  std::string key;           ///< in the rig file (rig_yaml.h)
  std::string found;
  std::string wanted;
};

// Sizes of images for which the network's image can be computed.
inline constexpr int kLeastImageSide_px = 16;
inline constexpr int kMostImageSide_px = 9920;

/// The first mistake of the rig, or nothing. Each camera must have
/// - images whose sides are 16 to 9920 pixels, with at least one row for 40 columns,
/// - a focal length of 0.05 to 6 times the width of its image, alike along both axes to a factor 2,
/// - a principal point outside of its image by at most half the image's size,
/// - a distortion that gives every pixel its own ray (of a fisheye up to kWidestFisheye_rad),
/// - a place 0.1 to 6 m above the ground,
/// - an optical axis from 60 degrees down to 30 degrees up, and a roll of at most 15 degrees,
/// - an optical axis within 55 degrees of the direction of its name: front 0, front_left 60,
///   back_left 120, back 180 degrees to the left, and the right cameras as their mirror images.
/// From right to left, each camera must look at least 10 degrees further to the left than the one
/// before it.
std::optional<RigMistake> find_mistake(const Rig& rig);

}  // namespace bevloc
