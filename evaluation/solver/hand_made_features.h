// Features of masks and rasters, computed without a network and prepared as a solver prepares them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/solver/cell_features.h"

namespace bevloc::evaluation {

/// Hand-made features (sim/perception/mask_features.h) on kFeatureGrid, [channel, row, column].
/// `mask`: kRasterSize probabilities; `raster`: kRasterSize bytes.
std::vector<float> features_of(std::span<const float> mask, int channels);
std::vector<float> features_of(std::span<const uint8_t> raster, int channels);

/// Features on kFeatureGrid, standardised as Solver does it, with a margin for `hypotheses`. Some
/// channel must vary.
CellFeatures standardised_cells(std::span<const float> features, int channels,
                                const HypothesisGrid& hypotheses);

}  // namespace bevloc::evaluation
