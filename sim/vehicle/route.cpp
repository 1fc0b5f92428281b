#include "sim/vehicle/route.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

/// The distance that can be driven from the start of each lane, at most `enough_m`.
std::vector<double> reach_of_lanes(const HdMap& map, const std::vector<double>& lane_m,
                                   double enough_m) {
  std::vector<double> reach = lane_m;
  bool changed = true;
  while (changed) {
    changed = false;
    for (size_t i = 0; i < map.lanes.size(); ++i) {
      for (const uint32_t next : map.lanes[i].successors) {
        const double longer = std::min(enough_m, lane_m[i] + reach[next]);
        if (longer <= reach[i]) continue;
        reach[i] = longer;
        changed = true;
      }
    }
  }
  return reach;
}

}  // namespace

std::vector<uint32_t> random_lane_route(const HdMap& map, double length_m, Random& random) {
  assert(!map.lanes.empty());
  std::vector<double> lane_m;
  double longest_m = 0.0;
  for (const Lane& lane : map.lanes) {
    lane_m.push_back(polyline_length(lane.centerline));
    longest_m = std::max(longest_m, lane_m.back());
  }
  const std::vector<double> reach = reach_of_lanes(map, lane_m, length_m + longest_m);

  const double best = *std::max_element(reach.begin(), reach.end());
  std::vector<uint32_t> starts;
  for (uint32_t i = 0; i < reach.size(); ++i) {
    if (reach[i] >= std::min(best, length_m)) starts.push_back(i);
  }
  uint32_t lane = starts[random.index(starts.size())];

  std::vector<int> visits(map.lanes.size(), 0);
  std::vector<uint32_t> route{lane};
  double left_m = length_m - lane_m[lane];
  while (left_m > 0.0 && !map.lanes[lane].successors.empty()) {
    ++visits[lane];
    double best_score = std::numeric_limits<double>::max();
    uint32_t best_next = map.lanes[lane].successors.front();
    for (const uint32_t next : map.lanes[lane].successors) {
      // Avoiding a dead end matters more than the number of visits.
      const double missing_m = std::max(0.0, left_m - reach[next]);
      const double score = 1e3 * missing_m + visits[next] + random.uniform();
      if (score < best_score) {
        best_score = score;
        best_next = next;
      }
    }
    lane = best_next;
    route.push_back(lane);
    left_m -= std::max(lane_m[lane], kLeastStep_m);
  }
  return route;
}

}  // namespace bevloc::sim
