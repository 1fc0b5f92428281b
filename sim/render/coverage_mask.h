// Exact area coverage of polygons on a pixel grid.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace bevloc::sim {

/// Collects polygons and then gives, row by row, how much of each cell they cover: the sum of their
/// areas, at most 1. Cell (i, j) is the unit square around the point (i, j). The accumulation
/// buffer holds each cell's change against its left neighbour (as in font rasterizers).
class CoverageMask {
 public:
  CoverageMask(int width, int height);

  void clear();
  /// Vertices in cell coordinates; either orientation; not repeating the first one.
  void add(std::span<const Eigen::Vector2f> ring);

  enum class RowKind { kEmpty, kFull, kMixed };
  /// Writes `width` values only when the row is mixed.
  RowKind row(int j, float* coverage) const;

 private:
  struct RowState {
    float offset = 0.0F;  ///< coverage that comes from the left of the grid
    int first = 0;        ///< cells that edges run through, and the one after: [first, last]
    int last = -1;
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
