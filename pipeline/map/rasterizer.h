// Draws the raster, the map around a pose as input of the network (S in the paper, III-B).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/se2.h"
#include "pipeline/bev_grid.h"
#include "pipeline/map/map_index.h"

namespace bevloc {

/// Line width in a raster: 5 cells = 0.75 m, as in HDMapNet.
inline constexpr int kRasterLineWidthCells = 5;

/// Size of a raster in bytes: [3, 400, 200], channels in the order of ElementClass.
inline constexpr size_t kRasterSize =
    static_cast<size_t>(kRasterChannels) * kRasterGrid.rows * kRasterGrid.cols;

/// Draws rasters with anti-aliasing: 0 is empty, 255 is covered. The centre of mass of a drawn line
/// is accurate to a tenth of a cell. Only the two longest edges of a crossing are drawn, as in
/// BeMapNet. One thread. Allocates nothing after a warm-up. The index must outlive it.
class MapRasterizer {
 public:
  explicit MapRasterizer(const MapIndex& index);

  /// Overwrites `raster`, which must have kRasterSize bytes.
  void draw(const Se2& map_from_vehicle, std::span<uint8_t> raster);

 private:
  const MapIndex& index_;
  std::vector<MapIndex::Segment> found_;
};

}  // namespace bevloc
