// Computes the exact area coverage of polygons on a pixel grid.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace bevloc::sim {

/// Collects polygons and then returns, row by row, the covered share of each cell: the sum of the
/// covered areas, at most 1. Cell (i, j) is the unit square around the point (i, j). As in font
/// rasterizers, the buffer stores the difference between each cell and its left neighbour. One
/// thread.
class CoverageMask {
 public:
  CoverageMask(int width, int height);

  /// Removes all polygons.
  void clear();
  /// Adds a polygon. Vertices are in cell coordinates, in either orientation; the first one is not
  /// repeated at the end.
  void add(std::span<const Eigen::Vector2f> ring);

  enum class RowKind { kEmpty, kFull, kMixed };
  /// Returns the kind of row j. Writes `width` values to `coverage` only if the row is mixed.
  RowKind row(int j, float* coverage) const;

 private:
  struct RowState {
    float offset = 0.0F;  ///< coverage from edges left of the grid
    int first = 0;        ///< first cell with an edge
    int last = -1;        ///< one past the last cell with an edge; below `first` without edges
    bool has_edges() const { return first <= last; }
  };
  void add_edge(Eigen::Vector2f from, Eigen::Vector2f to, float sign);
  void deposit(int j, float x_from, float x_to, float area);

  int width_;
  int height_;
  std::vector<float> deltas_;
  std::vector<RowState> rows_;
};

}  // namespace bevloc::sim
