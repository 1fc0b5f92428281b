// Computes hand-made feature channels from a mask, as a substitute for a network.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/bev_grid.h"

namespace bevloc::sim {

/// Computes non-negative channels, in the same way for a perceived mask and for a map's raster:
///
///    3  the three masks
///    4  the masks and their union (their maximum)
///   16  per class: blurred by 0.3 m, blurred by 0.9 m, |d/dx| and |d/dy| of the first blur (per
///       metre), exp(-distance / 1 m); and the union blurred by 0.3 m
///   64  per class: the mask, five blurs, slopes in four directions at two scales, ridges in four
///       directions, exp(-distance / length) for three lengths; and the union blurred by 0.3 m
///
/// Distances are to the nearest cell above 0.5. Everything is computed on kRasterGrid and then
/// averaged over the cells of the feature grid. One thread.
class MaskFeatures {
 public:
  /// `channels` is 3, 4, 16 or 64; `grid` is kFeatureGrid or kRasterGrid.
  MaskFeatures(int channels, const BevGrid& grid);

  /// `mask` has kRasterSize probabilities. `features`, [channels, rows, cols], is overwritten
  /// completely.
  void compute(std::span<const float> mask, std::span<float> features);
  /// `raster` has kRasterSize bytes, as MapRasterizer draws them.
  void compute(std::span<const uint8_t> raster, std::span<float> features);

 private:
  int channels_;
  BevGrid grid_;
  std::vector<float> mask_;  ///< the raster as probabilities
};

}  // namespace bevloc::sim
