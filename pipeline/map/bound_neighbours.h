// Judges the bounds of lanelets for vehicles by the lines that run beside them.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/line_neighbours.h"

namespace bevloc {

/// Add all lanelets and lines before the first call of a query. One thread.
class BoundNeighbours {
 public:
  /// Adds the ways of both bounds of one lanelet. They do not count as neighbours of each other.
  void add_lanelet(const std::vector<int64_t>& ways);

  /// Adds a way whose type says that it is a road boundary, or that bounds a lanelet for vehicles.
  void add_line(int64_t way, const Polyline& points, bool is_typed_boundary);

  /// Whether a divider is the edge of the road, because no other line runs beside it.
  bool is_edge_of_road(int64_t way, const Polyline& points) const;

  /// Whether a road boundary runs on a bound without a type.
  bool is_on_boundary(int64_t way, const Polyline& points) const;

  /// Whether a bound without a type runs on one of a neighbouring lanelet.
  bool is_on_bound(int64_t way, const Polyline& points) const;

  /// Whether this way is the same line as the way of an earlier call. Call it only for ways for
  /// which is_on_bound() is true.
  bool is_second_of_a_pair(int64_t way, const Polyline& points);

 private:
  /// Whether a line is neither the way itself nor a bound of a lanelet that the way bounds.
  bool is_foreign(int64_t way, int64_t other) const;

  LineNeighbours lines_;
  std::unordered_set<int64_t> typed_boundaries_;
  /// For each way, the ways of both bounds of its lanelets.
  std::unordered_map<int64_t, std::vector<int64_t>> own_;
  std::unordered_set<int64_t> drawn_by_pairs_;
};

}  // namespace bevloc
