// The table of the camera pixels that each network pixel averages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/preprocessing/network_camera.h"
#include "pipeline/preprocessing/remap_blocks.h"

namespace bevloc {

inline constexpr int kNetworkPixels = kNetworkWidthPx * kNetworkHeightPx;
inline constexpr PixelRange kAllNetworkPixels{0, kNetworkPixels};

/// For each network pixel, the box of camera pixels that it averages.
struct RemapTable {
  static constexpr int kWeightBits = 8;
  static constexpr int kWeightSum = 1 << kWeightBits;
  static constexpr int kMaxTaps = 32;

  int taps = 0;  ///< width of the box filter in pixels, along each axis
  std::vector<uint16_t> first_col;
  std::vector<uint16_t> first_row;
  /// For each network pixel, the weights of its columns, then those of its rows. Each set sums to
  /// kWeightSum, or to 0 outside the camera image and on the own vehicle.
  std::vector<uint16_t> weights;
  RemapBlocks blocks;  ///< the same boxes for the kernels
};

/// The table from images of `camera` to images of network_camera(camera).
RemapTable make_remap_table(const CameraModel& camera);

}  // namespace bevloc
