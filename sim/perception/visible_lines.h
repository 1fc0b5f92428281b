// The map's lines around a vehicle, as its cameras could see them.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/map/map_index.h"
#include "sim/perception/dashed_line.h"

namespace bevloc::sim {

/// A stretch of line in the vehicle frame, with a point at least every half metre. Elements that
/// continue one another are one line; a crossing gives its two longest edges, as the rasterizer
/// draws it.
struct VisibleLine {
  ElementClass element_class = ElementClass::kLaneDivider;
  uint32_t element = 0;  ///< of the map: the two edges of a crossing share it
  bool of_ring = false;  ///< part of a closed line: an island's or a median's outline
  bool begins = false;   ///< its first point is a line end, not a cut at the box
  bool ends = false;     ///< and so is its last one
  std::vector<Eigen::Vector2d> points;
  std::vector<bool> painted;  ///< of each piece between two points; false in the gaps of dashes
};

/// The lines within the raster's box grown by a margin, in the map's order. `dashes` are those of
/// the index's map: a dashed line is one line, painted here and there.
std::vector<VisibleLine> visible_lines(const MapIndex& index, const Se2& map_from_vehicle,
                                       double margin_m, const MapDashes& dashes = {});

}  // namespace bevloc::sim
