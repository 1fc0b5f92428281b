// Draws one localization on a sheet, as in the paper's Fig. 5.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/image.h"
#include "common/result.h"
#include "common/se2.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/map/map_index.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/solver_result.h"

namespace bevloc::evaluation {

/// Everything that the sheet shows, copied from the running pipeline.
struct SheetContent {
  std::array<RgbImage, kCameraCount> images;
  CameraMask present;
  /// The vehicle's pose at each camera's exposure, in the vehicle frame at the time of the poses.
  CameraMotions reference_from_exposure{};
  Se2 prior;                       ///< GNSS and odometry alone
  Se2 corrected;                   ///< bevloc's pose at the same moment
  std::optional<Se2> truth;        ///< if it is known
  std::vector<float> mask_logits;  ///< the network's mask, [3, 400, 200]
  Se2 matched_at;                  ///< T0: the pose of the network's raster
  SolverResult solution;           ///< the solution for dT
  HypothesisGrid hypotheses;       ///< the axes of the distributions
};

/// Writes a PNG: (a) the perceived BEV over the map at the corrected pose, (b) the six images with
/// the map at the prior and (c) at the corrected pose, (d) the three distributions. Fails if the
/// file cannot be written.
Status write_sheet(const SheetContent& content, const Rig& rig, const MapIndex& map,
                   const std::string& path);

}  // namespace bevloc::evaluation
