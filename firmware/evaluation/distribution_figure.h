// What solvers answer: a picture as the paper's Fig. 5d.
#pragma once

#include <span>
#include <string>

#include "common/result.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {

/// One row for each scene: P(x), P(y) and P(yaw) of full-fft, decoupled and decoupled+refine, with
/// the truth, and each one's mean with the deviation it claims.
Status draw_distributions(std::span<const sim::MatchingScene> scenes, const std::string& path);

}  // namespace bevloc::evaluation
