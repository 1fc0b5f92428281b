// Draws the map around a pose as the network's raster (paper, III-B: the semantic mask S).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/se2.h"
#include "pipeline/bev_grid.h"
#include "pipeline/map/map_index.h"

namespace bevloc {

/// Line width of a raster: 5 cells = 0.75 m, HDMapNet's choice.
inline constexpr int kRasterLineWidthCells = 5;

/// Number of bytes of one raster: channel by channel (ElementClass order), row by row.
inline constexpr size_t kRasterSize =
    static_cast<size_t>(kRasterChannels) * kRasterGrid.rows * kRasterGrid.cols;

/// Crops the map around a pose and draws it, anti-aliased, 0 (empty) to 255 (covered), with
/// sub-cell accuracy: a line's centre of mass lies where the line is to within a tenth of a cell.
/// A crossing is drawn as its two longest edges, as BeMapNet does.
/// Not thread safe (it owns scratch buffers); no allocation once warm.
class MapRasterizer {
 public:
  explicit MapRasterizer(const MapIndex& index);

  /// raster has kRasterSize bytes and is overwritten whole.
  void draw(const Se2& map_from_vehicle, std::span<uint8_t> raster);

 private:
  const MapIndex& index_;
  std::vector<MapIndex::Segment> found_;
};

}  // namespace bevloc
