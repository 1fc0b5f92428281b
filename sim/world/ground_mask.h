// Where in the town there is room for a house or a tree.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "sim/world/world.h"

namespace bevloc::sim {

/// A coarse raster (1 m) of what is paved or built on.
class GroundMask {
 public:
  /// Covers the paved rings and a margin around them.
  explicit GroundMask(const std::vector<const Ring*>& paved);

  /// To the nearest pavement, to 2 m or so; 0 on it and outside the raster.
  double distance_to_paved_m(const Eigen::Vector2d& point) const;
  /// Whether neither pavement nor a building lies on the line or ring (which is closed).
  bool is_free(const Ring& ring) const;
  void occupy(const Ring& ring);
  void occupy_line(const Polyline& line);

  Eigen::Vector2d min_corner() const { return min_corner_; }
  Eigen::Vector2d max_corner() const;

 private:
  bool cell_at(const Eigen::Vector2d& point, cv::Point& cell) const;
  std::vector<cv::Point> fixed_point(const Polyline& line) const;

  Eigen::Vector2d min_corner_;
  cv::Mat occupied_;  ///< uint8: 255 paved or built on
  cv::Mat distance_;  ///< float, coarser: to pavement
};

}  // namespace bevloc::sim
