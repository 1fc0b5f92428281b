#include "pipeline/map/bound_neighbours.h"

#include <algorithm>

namespace bevloc {
namespace {

/// Another line runs beside a line if it is at most this far from it.
constexpr double kBesideEdge_m = 2.5;
/// A line is the edge of the road if other lines run beside at most this share of it.
constexpr double kEdgeShare = 0.5;
/// Two ways are the same line if they are at most this far apart along at least this share.
constexpr double kSameLine_m = 0.5;
constexpr double kSameLineShare = 0.8;

}  // namespace

void BoundNeighbours::add_lanelet(const std::vector<int64_t>& ways) {
  for (const int64_t way : ways) own_[way].insert(own_[way].end(), ways.begin(), ways.end());
}

void BoundNeighbours::add_line(int64_t way, const Polyline& points, bool is_typed_boundary) {
  lines_.add(way, points);
  if (is_typed_boundary) typed_boundaries_.insert(way);
}

bool BoundNeighbours::is_foreign(int64_t way, int64_t other) const {
  if (other == way) return false;
  const auto own = own_.find(way);
  return own == own_.end() || std::ranges::find(own->second, other) == own->second.end();
}

bool BoundNeighbours::is_edge_of_road(int64_t way, const Polyline& points) const {
  const auto counts = [&](int64_t other) { return is_foreign(way, other); };
  return lines_.share_beside(points, kBesideEdge_m, counts) <= kEdgeShare;
}

bool BoundNeighbours::is_on_boundary(int64_t way, const Polyline& points) const {
  const auto counts = [&](int64_t other) {
    return is_foreign(way, other) && typed_boundaries_.contains(other);
  };
  return lines_.share_beside(points, kSameLine_m, counts) >= kSameLineShare;
}

bool BoundNeighbours::is_on_bound(int64_t way, const Polyline& points) const {
  const auto counts = [&](int64_t other) {
    return is_foreign(way, other) && !typed_boundaries_.contains(other);
  };
  return lines_.share_beside(points, kSameLine_m, counts) >= kSameLineShare;
}

bool BoundNeighbours::is_second_of_a_pair(int64_t way, const Polyline& points) {
  drawn_by_pairs_.insert(way);
  const auto counts = [&](int64_t other) {
    return other != way && drawn_by_pairs_.contains(other);
  };
  return lines_.share_beside(points, kSameLine_m, counts) >= kSameLineShare;
}

}  // namespace bevloc
