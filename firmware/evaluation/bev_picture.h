// Masks and features seen from above: their pictures, and the features themselves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "pipeline/bev_grid.h"
#include "pipeline/solver/cell_features.h"

namespace bevloc::evaluation {

/// The classes' colours on white, the front at the top. `planes`: [ElementClass][row][column] of a
/// grid, from 0 (empty) to 1.
cv::Mat3b bev_picture(std::span<const float> planes, const BevGrid& grid);
cv::Mat3b bev_picture(std::span<const uint8_t> raster);

/// Lays a raster of the map under a picture of kRasterGrid, in grey.
void shade(std::span<const uint8_t> raster, cv::Mat3b& picture);

/// Hand-made features (sim/perception/mask_features.h) of a mask on kFeatureGrid.
std::vector<float> features_of(std::span<const float> mask, int channels);
std::vector<float> features_of(std::span<const uint8_t> raster, int channels);

/// The same as the solvers read them.
CellFeatures standardised_cells(std::span<const float> features, int channels,
                                const HypothesisGrid& hypotheses);

}  // namespace bevloc::evaluation
