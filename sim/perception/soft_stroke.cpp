#include "sim/perception/soft_stroke.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "pipeline/bev_grid.h"
#include "pipeline/map/cell_segment.h"

namespace bevloc::sim {
namespace {

/// A point of a stroke in fractional cells.
struct CellPoint {
  float col;
  float row;
  float half_width;
  float strength;
  float softness;
};

CellPoint in_cells(const StrokePoint& point) {
  const auto cells = [](double metres) { return static_cast<float>(metres / kRasterGrid.cell_m); };
  return {static_cast<float>(kRasterGrid.col_of_y(point.position_m.y())),
          static_cast<float>(kRasterGrid.row_of_x(point.position_m.x())), cells(point.half_width_m),
          static_cast<float>(point.strength), cells(point.softness_m)};
}

/// The range [first, last] of cells along one axis that a piece may touch; empty if first > last.
struct CellSpan {
  int first;
  int last;
};

/// The cells within `reach` of the range between a and b.
CellSpan touched(float a, float b, float reach, int count) {
  return {std::max(0, static_cast<int>(std::ceil(std::min(a, b) - reach))),
          std::min(count - 1, static_cast<int>(std::floor(std::max(a, b) + reach)))};
}

void draw_piece(const CellPoint& from, const CellPoint& to, std::span<float> cells) {
  const float reach = std::max(from.half_width + from.softness, to.half_width + to.softness);
  const CellSpan rows = touched(from.row, to.row, reach, kRasterGrid.rows);
  const CellSpan cols = touched(from.col, to.col, reach, kRasterGrid.cols);
  const CellSegment segment(from.col, from.row, to.col - from.col, to.row - from.row);
  for (int row = rows.first; row <= rows.last; ++row) {
    float* line = cells.data() + static_cast<size_t>(row) * kRasterGrid.cols;
    for (int col = cols.first; col <= cols.last; ++col) {
      const auto [along, distance] = segment.nearest(col, row);
      const float half_width = from.half_width + along * (to.half_width - from.half_width);
      const float softness = from.softness + along * (to.softness - from.softness);
      const float strength = from.strength + along * (to.strength - from.strength);
      const float cover =
          std::min(std::max((half_width + softness - distance) / (2.0F * softness), 0.0F), 1.0F);
      line[col] = std::max(line[col], strength * cover);
    }
  }
}

}  // namespace

void draw_stroke(std::span<const StrokePoint> stroke, std::span<float> cells) {
  assert(cells.size() == static_cast<size_t>(kRasterGrid.cells()));
  for (size_t i = 1; i < stroke.size(); ++i) {
    draw_piece(in_cells(stroke[i - 1]), in_cells(stroke[i]), cells);
  }
}

}  // namespace bevloc::sim
