// Ways to localize that were there before learned matching, for comparison on the same frames.
#pragma once

#include <cstdint>
#include <span>

#include "common/se2.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

/// What a baseline may read of one frame: what the network and its solver read, or perceived.
struct BaselineInput {
  std::span<const uint8_t> images;   ///< [camera, colour, row, column] of the network cameras
  CameraMask cameras;                ///< those whose images are there
  std::span<const float> perceived;  ///< kRasterSize probabilities, in the vehicle frame
  std::span<const uint8_t> raster;   ///< the map drawn at T0, kRasterSize
};

/// Not thread safe.
class Baseline {
 public:
  virtual ~Baseline() = default;

  /// The correction dT = T0^-1 T; zero where there is nothing to match.
  virtual Se2 correct(const BaselineInput& input) = 0;
};

}  // namespace bevloc::evaluation
