// Hand-made feature channels of a mask, in a network's place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/bev_grid.h"

namespace bevloc::sim {

/// Turns a mask into non-negative channels, the same way for a perceived mask and a map's raster:
///
///    3  the masks
///    4  the masks and their union (the largest of the three)
///   16  of each class: blurred by 0.3 m and by 0.9 m, |d/dx| and |d/dy| of the former (per metre),
///       exp(-distance / 1 m); and the union blurred by 0.3 m
///   64  of each class: itself, five blurs, slopes in four directions at two scales, ridges in four
///       directions, exp(-distance) at three lengths; and the union blurred by 0.3 m
///
/// Distances are to the cells above one half. All is computed on kRasterGrid and then averaged over
/// the cells of the feature grid. Not thread safe.
class MaskFeatures {
 public:
  /// `channels` is 3, 4, 16 or 64; `grid` is kFeatureGrid or kRasterGrid.
  MaskFeatures(int channels, const BevGrid& grid);

  /// mask: kRasterSize probabilities. features: [channels, rows, cols], overwritten whole.
  void compute(std::span<const float> mask, std::span<float> features);
  /// raster: kRasterSize bytes, as MapRasterizer draws them.
  void compute(std::span<const uint8_t> raster, std::span<float> features);

 private:
  int channels_;
  BevGrid grid_;
  std::vector<float> mask_;  ///< a raster as probabilities
};

}  // namespace bevloc::sim
