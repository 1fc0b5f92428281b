// The ground as cameras see it, seen from above: inverse perspective mapping.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

/// Brightness (0 to 255) on kRasterGrid, and which cells a camera sees sharply enough to tell paint
/// there; the others are 0.
struct GroundPicture {
  cv::Mat1f brightness;
  cv::Mat1b seen;  ///< 255 or 0
};

/// Projects the cells of kRasterGrid on level ground into the network cameras of a rig, once.
class GroundView {
 public:
  explicit GroundView(const Rig& network_rig);

  /// Each cell is read, bilinearly, from the camera that has it farthest from its image border.
  /// `images` is [camera, colour, row, column] and read where `cameras` says so.
  GroundPicture look(std::span<const uint8_t> images, CameraMask cameras) const;

 private:
  /// How a camera sees a cell.
  struct Sighting {
    Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
    float border_distance_px = 0.0F;  ///< 0: it does not see the cell, or too far off
  };

  std::vector<std::array<Sighting, kCameraCount>> sightings_;  ///< of each cell
};

}  // namespace bevloc::evaluation
