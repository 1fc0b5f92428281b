// Finds the same place of the ground in two pictures, to a fraction of a pixel.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/calibration/refine/grey_image.h"
#include "pipeline/calibration/refine/moment_view.h"

namespace bevloc {

/// A tie point: the pixels of one place on the ground in two pictures.
struct GroundTie {
  Eigen::Vector2d first_px;
  Eigen::Vector2d second_px;
};

struct TieSearch {
  double reach_px = 6.0;  ///< distance to each side of where the views have the place
  double spacing_px = 32.0;
  double farthest_m = 20.0;  ///< distance from the camera
};

/// Searches the second picture for patches of the ground that lie on a grid in the first picture. A
/// patch makes a tie if its texture differs along both axes, and if exactly one place within the
/// reach agrees with it.
std::vector<GroundTie> find_ties(const GreyImage& first, const MomentView& first_view,
                                 const GreyImage& second, const MomentView& second_view,
                                 const TieSearch& search);

}  // namespace bevloc
