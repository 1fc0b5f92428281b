// Finds the map elements near a place.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

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
  explicit MapIndex(HdMap&& map) = delete;
  MapIndex(const MapIndex&) = delete;
  MapIndex& operator=(const MapIndex&) = delete;
  ~MapIndex();

  const HdMap& map() const { return map_; }

  /// Replaces `found` with the segments whose bounding box meets the given one, in a fixed order
  /// (by element, then by point). Time grows with the result, not with the map. No allocation
  /// beyond the growth of `found`.
  void query(const Eigen::Vector2d& min_corner, const Eigen::Vector2d& max_corner,
             std::vector<Segment>& found) const;

 private:
  struct Tree;

  const HdMap& map_;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace bevloc
