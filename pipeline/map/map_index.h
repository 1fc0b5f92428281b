// Finds the map elements near a place.
#pragma once

#include <Eigen/Core>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cstdint>
#include <vector>

#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Spatial index over a map's line segments. Keeps a reference to the map: the map must outlive it.
/// Safe to query from several threads.
class MapIndex {
 public:
  /// A segment of an element: from its point `first` to the next (a ring's last closes it).
  struct Segment {
    uint32_t element;
    uint32_t first;
  };

  explicit MapIndex(const HdMap& map);

  const HdMap& map() const { return map_; }

  /// Replaces `found` with the segments whose bounding box meets the given one, in a fixed order
  /// (by element, then by point). Time grows with the result, not with the map.
  void query(const Eigen::Vector2d& min_corner, const Eigen::Vector2d& max_corner,
             std::vector<Segment>& found) const;

 private:
  using Point = boost::geometry::model::point<double, 2, boost::geometry::cs::cartesian>;
  using Box = boost::geometry::model::box<Point>;
  using Entry = std::pair<Box, Segment>;

  const HdMap& map_;
  boost::geometry::index::rtree<Entry, boost::geometry::index::rstar<16>> tree_;
};

}  // namespace bevloc
