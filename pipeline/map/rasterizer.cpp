#include "pipeline/map/rasterizer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "pipeline/map/cell_segment.h"

namespace bevloc {
namespace {

/// The value falls from 255 to 0 over one cell, centred on the edge of the line.
constexpr double kOuterRadiusCells = 0.5 * kRasterLineWidthCells + 0.5;
/// Segments are clipped this far outside the raster, so that the new ends are not visible.
constexpr double kClipMarginCells = kOuterRadiusCells + 1.0;

/// A segment in cells: x() is the column, y() the row. Integers are cell centres.
struct RasterSegment {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

/// The part of a segment inside the raster and its margin (Liang-Barsky clipping).
std::optional<RasterSegment> clip_to_raster(const RasterSegment& segment) {
  const Eigen::Vector2d low = Eigen::Vector2d::Constant(-kClipMarginCells);
  const Eigen::Vector2d high(kRasterGrid.cols - 1 + kClipMarginCells,
                             kRasterGrid.rows - 1 + kClipMarginCells);
  const Eigen::Vector2d direction = segment.to - segment.from;
  double enter = 0.0;
  double leave = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double start = segment.from[axis];
    if (direction[axis] == 0.0) {
      if (start < low[axis] || start > high[axis]) return std::nullopt;
      continue;
    }
    const double at_low = (low[axis] - start) / direction[axis];
    const double at_high = (high[axis] - start) / direction[axis];
    enter = std::max(enter, std::min(at_low, at_high));
    leave = std::min(leave, std::max(at_low, at_high));
  }
  if (enter > leave) return std::nullopt;
  return RasterSegment{segment.from + enter * direction, segment.from + leave * direction};
}

/// The columns of one row that a segment may cover, from `first` to `last`; empty if first > last.
struct ColumnSpan {
  int first;
  int last;
};

ColumnSpan covered_columns(const RasterSegment& segment, int row) {
  const Eigen::Vector2d direction = segment.to - segment.from;
  double begin = 0.0;
  double end = 1.0;
  if (std::abs(direction.y()) > 1e-9) {
    const double at_above = (row - kOuterRadiusCells - segment.from.y()) / direction.y();
    const double at_below = (row + kOuterRadiusCells - segment.from.y()) / direction.y();
    begin = std::clamp(std::min(at_above, at_below), 0.0, 1.0);
    end = std::clamp(std::max(at_above, at_below), 0.0, 1.0);
  }
  const double col_begin = segment.from.x() + begin * direction.x();
  const double col_end = segment.from.x() + end * direction.x();
  const double low = std::min(col_begin, col_end) - kOuterRadiusCells;
  const double high = std::max(col_begin, col_end) + kOuterRadiusCells;
  return {std::max(0, static_cast<int>(std::ceil(low))),
          std::min(kRasterGrid.cols - 1, static_cast<int>(std::floor(high)))};
}

/// Raises each cell of a row to its coverage by the segment, which depends on the distance.
void draw_row(const RasterSegment& segment, int row, const ColumnSpan& span, uint8_t* cells) {
  const CellSegment line(static_cast<float>(segment.from.x()), static_cast<float>(segment.from.y()),
                         static_cast<float>(segment.to.x() - segment.from.x()),
                         static_cast<float>(segment.to.y() - segment.from.y()));
  for (int col = span.first; col <= span.last; ++col) {
    const float distance = line.nearest(col, row).distance;
    const float cover =
        std::min(std::max(static_cast<float>(kOuterRadiusCells) - distance, 0.0F), 1.0F);
    const auto value = static_cast<uint8_t>(static_cast<int>(cover * 255.0F + 0.5F));
    cells[col] = std::max(cells[col], value);
  }
}

/// Draws one segment with round ends, so that polylines have no gaps at their joints.
void draw_segment(const RasterSegment& segment, uint8_t* channel) {
  const double top = std::min(segment.from.y(), segment.to.y()) - kOuterRadiusCells;
  const double bottom = std::max(segment.from.y(), segment.to.y()) + kOuterRadiusCells;
  const int first_row = std::max(0, static_cast<int>(std::ceil(top)));
  const int last_row = std::min(kRasterGrid.rows - 1, static_cast<int>(std::floor(bottom)));
  for (int row = first_row; row <= last_row; ++row) {
    draw_row(segment, row, covered_columns(segment, row),
             channel + static_cast<size_t>(row) * kRasterGrid.cols);
  }
}

/// Whether an edge is one of the two longest of its ring. Of equal edges, the first ones count.
bool is_long_edge(const std::vector<Eigen::Vector2d>& ring, size_t edge) {
  const auto length_squared = [&ring](size_t i) {
    return (ring[(i + 1) % ring.size()] - ring[i]).squaredNorm();
  };
  const double own = length_squared(edge);
  int longer = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const double other = length_squared(i);
    if (other > own || (other == own && i < edge)) ++longer;
  }
  return longer < 2;
}

/// Half the size, along the axes of the map, of the box around the raster with its margin.
Eigen::Vector2d half_extent_in_map(double yaw_rad) {
  const double margin_m = kClipMarginCells * kRasterGrid.cell_m;
  const double half_x = kRasterGrid.x_range_m() + margin_m;
  const double half_y = kRasterGrid.y_range_m() + margin_m;
  const double c = std::abs(std::cos(yaw_rad));
  const double s = std::abs(std::sin(yaw_rad));
  return {c * half_x + s * half_y, s * half_x + c * half_y};
}

}  // namespace

MapRasterizer::MapRasterizer(const MapIndex& index) : index_(index) {}

void MapRasterizer::draw(const Se2& map_from_vehicle, std::span<uint8_t> raster) {
  assert(raster.size() == kRasterSize);
  assert(map_from_vehicle.is_finite());
  std::fill(raster.begin(), raster.end(), uint8_t{0});

  const Eigen::Vector2d half_extent = half_extent_in_map(map_from_vehicle.yaw_rad);
  index_.query(map_from_vehicle.translation() - half_extent,
               map_from_vehicle.translation() + half_extent, found_);

  const Se2 vehicle_from_map = map_from_vehicle.inverse();
  const auto cell_of = [&vehicle_from_map](const Eigen::Vector2d& point_map) {
    const Eigen::Vector2d point = vehicle_from_map * point_map;
    return Eigen::Vector2d(kRasterGrid.col_of_y(point.y()), kRasterGrid.row_of_x(point.x()));
  };
  for (const MapIndex::Segment& found : found_) {
    const MapElement& element = index_.map().elements[found.element];
    const auto& points = element.points;
    if (is_ring(element.element_class) && !is_long_edge(points, found.first)) continue;
    const auto visible =
        clip_to_raster({cell_of(points[found.first]), cell_of(segment_end(element, found.first))});
    if (!visible) continue;
    draw_segment(*visible,
                 raster.data() + static_cast<size_t>(element.element_class) * kRasterGrid.cells());
  }
}

}  // namespace bevloc
