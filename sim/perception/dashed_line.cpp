#include "sim/perception/dashed_line.h"

#include <algorithm>

namespace bevloc::sim {

DashedLine dashed_line(const std::vector<Eigen::Vector2d>& line, std::span<const Dash> dashes) {
  DashedLine result{{line.front()}, {}};
  auto dash = dashes.begin();
  double begin_m = 0.0;  // station where the segment begins
  for (size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector2d segment = line[i] - line[i - 1];
    const double end_m = begin_m + segment.norm();
    for (double station_m = begin_m; station_m < end_m;) {
      while (dash != dashes.end() && dash->to_m <= station_m) ++dash;
      const bool painted = dash != dashes.end() && dash->from_m <= station_m;
      double next_m = end_m;
      if (dash != dashes.end()) next_m = std::min(next_m, painted ? dash->to_m : dash->from_m);
      const double share = (next_m - begin_m) / (end_m - begin_m);
      result.points.emplace_back(line[i - 1] + share * segment);
      result.painted.push_back(painted);
      station_m = next_m;
    }
    begin_m = end_m;
  }
  return result;
}

std::vector<PointRange> painted_stretches(const std::vector<bool>& painted) {
  std::vector<PointRange> stretches;
  for (size_t i = 0; i < painted.size(); ++i) {
    if (!painted[i]) continue;
    if (i == 0 || !painted[i - 1]) stretches.push_back({i, i});
    stretches.back().last = i + 1;
  }
  return stretches;
}

}  // namespace bevloc::sim
