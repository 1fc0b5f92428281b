// A spatial index that finds the items of a world near a place.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace bevloc::sim {

using Box = Eigen::AlignedBox2d;

/// Stores items by number and bounding box in a grid of square cells. Immutable, and so
/// thread-safe.
class CellIndex {
 public:
  CellIndex() = default;
  explicit CellIndex(const std::vector<Box>& boxes);

  /// Appends the numbers of all items whose box intersects `area`, sorted and without duplicates.
  void query(const Box& area, std::vector<int>& items) const;

 private:
  Eigen::Vector2i cell_of(const Eigen::Vector2d& point) const;

  Box bounds_;
  double cell_size_m_ = 1.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::vector<int>> cells_;
  std::vector<Box> boxes_;
};

}  // namespace bevloc::sim
