// Interface of the baselines: localization methods without learned matching.
#pragma once

#include <cstdint>
#include <span>

#include "common/se2.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

/// The data of one sample: the same input as the network's, and the network's mask.
struct BaselineInput {
  std::span<const uint8_t> images;   ///< network input, [camera, colour, row, column]
  CameraMask cameras;                ///< the cameras that are present
  const Rig& rig;                    ///< the calibration of the cameras
  std::span<const float> perceived;  ///< the network's mask, kRasterSize probabilities
  std::span<const uint8_t> raster;   ///< the map at the prior pose T0, kRasterSize bytes
};

/// Finds the correction of a prior pose. One thread.
class Baseline {
 public:
  virtual ~Baseline() = default;

  /// The correction dT = T0^-1 T; zero if there is nothing to match.
  virtual Se2 correct(const BaselineInput& input) = 0;
};

}  // namespace bevloc::evaluation
