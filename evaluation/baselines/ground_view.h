// Inverse perspective mapping: projects the camera images onto the ground.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

/// The ground from above, on kRasterGrid: brightness 0 to 255, and the cells that some camera sees
/// sharply enough to find paint. All other cells are 0.
struct GroundImage {
  cv::Mat1f brightness;
  cv::Mat1b seen;  ///< 255 or 0
};

/// The constructor projects the cells of kRasterGrid, on level ground, into the cameras.
class GroundView {
 public:
  explicit GroundView(const Rig& network_rig);

  /// Reads each cell by bilinear interpolation from the camera in whose image it is farthest from
  /// the border. `images` is [camera, colour, row, column]; only those of `cameras` are read.
  GroundImage project(std::span<const uint8_t> images, CameraMask cameras) const;

 private:
  /// Where a cell appears in a camera's image.
  struct Projection {
    Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
    float border_distance_px = 0.0F;  ///< 0: not visible, or too far away
  };

  std::vector<std::array<Projection, kCameraCount>> projections_;  ///< by cell
};

}  // namespace bevloc::evaluation
