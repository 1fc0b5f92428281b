// A raster of the occupied ground, to find room for houses and trees.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "sim/world/world.h"

namespace bevloc::sim {

/// A raster with cells of 1 m that marks paved and built-on ground.
class GroundMask {
 public:
  /// The raster covers the paved rings and a margin of 40 m around them.
  explicit GroundMask(const std::vector<const Ring*>& paved);

  /// Distance to the nearest paved ground, to about 2 m; 0 on paved ground and outside the raster.
  double distance_to_paved_m(const Eigen::Vector2d& point) const;
  /// Whether the closed line touches neither paved nor occupied ground and stays in the raster.
  bool is_free(const Ring& ring) const;
  /// Marks an area as occupied.
  void occupy(const Ring& ring);
  void occupy_line(const Polyline& line);

  Eigen::Vector2d min_corner() const { return min_corner_; }
  Eigen::Vector2d max_corner() const;

 private:
  bool cell_at(const Eigen::Vector2d& point, cv::Point& cell) const;
  std::vector<cv::Point> fixed_point(const Polyline& line) const;

  Eigen::Vector2d min_corner_;
  cv::Mat occupied_;  ///< uint8; 255 if paved or built on
  cv::Mat distance_;  ///< float, in its own (coarser) cells: distance to paved ground
};

}  // namespace bevloc::sim
