// Draws lines on the ground: paint, tyre tracks, cracks.
#pragma once

#include "sim/render/tile_canvas.h"

namespace bevloc::sim {

/// One straight segment of a line, in the map frame.
struct StrokeSegment {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  double start_m = 0.0;  ///< arc length of `from` along the whole line, for the dashes
  int line = 0;          ///< index of the line that it belongs to
};

/// A dark stripe, darkest in the middle.
struct Soiling {
  double width_m = 0.5;
  float strength = 0.1F;
};

/// Paints a segment with anti-aliased edges, dashes and wear.
void draw_paint(TileCanvas& canvas, const StrokeSegment& segment, const PaintLine& line);

/// Darkens the road (asphalt alone) along a segment.
void draw_soiling(TileCanvas& canvas, const StrokeSegment& segment, const Soiling& soiling);

/// Appends the segments of a polyline, which get the index `line`.
void append_segments(const Polyline& points, int line, std::vector<StrokeSegment>& segments);

}  // namespace bevloc::sim
