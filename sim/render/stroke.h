// Lines on the ground: paint, tyre tracks, cracks.
#pragma once

#include "sim/render/tile_canvas.h"

namespace bevloc::sim {

/// One straight piece of a line, in the map.
struct StrokeSegment {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  double start_m = 0.0;  ///< arc length of `from` along the whole line, for the dashes
  int line = 0;          ///< which line it belongs to
};

/// A dark stripe, strongest in its middle.
struct Soiling {
  double width_m = 0.5;
  float strength = 0.1F;
};

/// Paints the piece with its anti-aliased edges, dashes and wear.
void draw_paint(TileCanvas& canvas, const StrokeSegment& segment, const PaintLine& line);

/// Darkens sealed road along the piece.
void draw_soiling(TileCanvas& canvas, const StrokeSegment& segment, const Soiling& soiling);

/// Cuts polylines into pieces with their arc lengths.
void append_segments(const Polyline& points, int line, std::vector<StrokeSegment>& segments);

}  // namespace bevloc::sim
