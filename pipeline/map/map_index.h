// Spatial index: finds the map elements in an area.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Spatial index over the line segments of a map. The map must outlive it. Thread-safe.
class MapIndex {
 public:
  /// The segment of an element from point `first` to the next; the last segment of a ring closes
  /// it.
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

  /// Replaces `found` with the segments whose bounding boxes intersect the given one, sorted by
  /// element, then by point. The time depends on the number of results rather than on the size of
  /// the map. Allocates only if `found` must grow.
  void query(const Eigen::Vector2d& min_corner, const Eigen::Vector2d& max_corner,
             std::vector<Segment>& found) const;

 private:
  struct Tree;

  const HdMap& map_;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace bevloc
