// What the solver of x and y reads: a picture as the paper's Fig. 4.
#pragma once

#include <string>

#include "common/result.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {

/// The map at the true pose, what is perceived there, and the same moved by 2 m along both axes;
/// with axis features of three channels along x and y, and the scores of the hypotheses.
Status draw_axis_features(const sim::MatchingScene& scene, const std::string& path);

}  // namespace bevloc::evaluation
