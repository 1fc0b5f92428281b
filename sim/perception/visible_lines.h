// Finds the lines of the map around a vehicle that its cameras could see.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/map/map_index.h"
#include "sim/perception/dashed_line.h"

namespace bevloc::sim {

/// A stretch of a line in the vehicle frame, with a point at least every 0.5 m. Elements that
/// continue each other are joined to one line. A crossing gives its two longest edges, as in the
/// rasterizer.
struct VisibleLine {
  ElementClass element_class = ElementClass::kLaneDivider;
  uint32_t element = 0;  ///< index in the map; the same for both edges of a crossing
  bool of_ring = false;  ///< part of a closed line, the outline of an island or a median
  bool begins = false;   ///< the first point is the end of the line, not a cut at the box
  bool ends = false;     ///< the last point is the end of the line, not a cut at the box
  std::vector<Eigen::Vector2d> points;
  std::vector<bool> painted;  ///< per segment; false in the gaps between dashes
};

/// The lines within the raster's box, enlarged by a margin, in the order of the map. `dashes`
/// belong to the index's map. A dashed line is one line with unpainted segments.
std::vector<VisibleLine> visible_lines(const MapIndex& index, const Se2& map_from_vehicle,
                                       double margin_m, const MapDashes& dashes = {});

}  // namespace bevloc::sim
