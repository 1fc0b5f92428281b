// The data of the paper's Fig. 5d: the distributions that several solvers compute for the same
// scenes.
#pragma once

#include <span>

#include <nlohmann/json_fwd.hpp>

#include "common/result.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {

/// The solutions of full-fft, decoupled and decoupled+refine on hand-made features.
///
///     solvers  names
///     scenes   {road, perceived and raster_prior: [channel][row][column] 0 to 255,
///               axes: {x_m, y_m, yaw_deg: {truth, hypotheses,
///                      solutions: one per solver {probability, mean, sigma}}}}
///
/// Fails as make_solver() does.
Result<nlohmann::json> distribution_figure(std::span<const sim::MatchingScene> scenes);

}  // namespace bevloc::evaluation
