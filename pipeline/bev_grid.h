// The bird's-eye-view (BEV) grids that network, map and solver share.
#pragma once

#include <numbers>

namespace bevloc {

/// A grid of square cells on the ground around the vehicle. Row 0 is the front edge, column 0 the
/// left edge. The vehicle's origin is the common corner of the four centre cells.
struct BevGrid {
  int rows = 0;
  int cols = 0;
  double cell_m = 0.0;

  constexpr int cells() const { return rows * cols; }
  constexpr double x_range_m() const { return 0.5 * rows * cell_m; }
  constexpr double y_range_m() const { return 0.5 * cols * cell_m; }

  /// Conversion between cell centres and vehicle coordinates. Rows and columns may be fractional.
  constexpr double x_of_row(double row) const { return x_range_m() - (row + 0.5) * cell_m; }
  constexpr double y_of_col(double col) const { return y_range_m() - (col + 0.5) * cell_m; }
  constexpr double row_of_x(double x_m) const { return (x_range_m() - x_m) / cell_m - 0.5; }
  constexpr double col_of_y(double y_m) const { return (y_range_m() - y_m) / cell_m - 0.5; }

  constexpr bool operator==(const BevGrid&) const = default;
};

/// Grid of the raster and of the mask: x in [-30, 30] m, y in [-15, 15] m, 0.15 m per cell.
inline constexpr BevGrid kRasterGrid{400, 200, 0.15};
/// Grid of the features that the solver matches: the same area, 0.6 m per cell.
inline constexpr BevGrid kFeatureGrid{100, 50, 0.6};

/// Channels of a raster: lane divider, pedestrian crossing, road boundary.
inline constexpr int kRasterChannels = 3;

}  // namespace bevloc
