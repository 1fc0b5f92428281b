// One picture of one localization, as in the paper's Fig. 5.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/image.h"
#include "common/result.h"
#include "common/se2.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/map/map_index.h"
#include "pipeline/solver/solver.h"

namespace bevloc::firmware {

/// Everything the picture shows, copied out of the running pipeline.
struct SheetContent {
  std::array<RgbImage, kCameraCount> images;
  CameraMask present;
  Se2 prior;      ///< GNSS and odometry alone
  Se2 corrected;  ///< bevloc's pose at the same moment
  Se2 truth;
  std::vector<float> mask_logits;  ///< perceived mask [3, 400, 200]
  Se2 matched_at;                  ///< T0: the pose the map was drawn at for the network
  SolverResult solution;           ///< of dT from there
  HypothesisGrid hypotheses;       ///< the axes of the solution's distributions
};

/// Draws (a) the perceived BEV over the map at the corrected pose, (b) the map at the prior and (c)
/// at the corrected pose over the six images, (d) the three distributions; writes a PNG.
Status write_sheet(const SheetContent& content, const Rig& rig, const MapIndex& map,
                   const std::string& path);

}  // namespace bevloc::firmware
