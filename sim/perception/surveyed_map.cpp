#include "sim/perception/surveyed_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

/// Shorter dashes, cut off at the end of a line, are dropped.
constexpr double kShortestDash_m = 0.1;
/// An element is at most this far from its paint; other lines are further away.
constexpr double kMostMapShift_m = 0.3;

/// Whether one line is the other one shifted by at most kMostMapShift_m.
bool is_shifted(const Polyline& line, const Polyline& from) {
  if (line.size() != from.size()) return false;
  const Eigen::Vector2d shift = line.front() - from.front();
  if (shift.norm() > kMostMapShift_m) return false;
  return std::equal(line.begin(), line.end(), from.begin(), [&shift](const auto& a, const auto& b) {
    return (a - b - shift).norm() < 1e-6;
  });
}

bool is_whole(const std::vector<Dash>& dashes) {
  return dashes.size() == 1 && dashes.front().to_m == kWholeLine.to_m;
}

std::vector<Dash> dashes_of(const PaintLine& paint) {
  const double end_m = polyline_length(paint.points);
  const double period_m = paint.dash_m + paint.gap_m;
  std::vector<Dash> dashes;
  for (double start_m = -std::fmod(paint.phase_m, period_m); start_m < end_m; start_m += period_m) {
    const Dash dash{std::max(0.0, start_m), std::min(end_m, start_m + paint.dash_m)};
    if (dash.to_m - dash.from_m > kShortestDash_m) dashes.push_back(dash);
  }
  return dashes;
}

}  // namespace

MapDashes painted_dashes(const World& world) {
  MapDashes dashes;
  for (const MapElement& element : world.map.elements) {
    dashes.push_back({kWholeLine});
    if (element.appearance != Appearance::kDashed) continue;
    const auto paint = std::find_if(
        world.paint_lines.begin(), world.paint_lines.end(), [&element](const PaintLine& line) {
          return line.dash_m > 0.0 && is_shifted(element.points, line.points);
        });
    if (paint != world.paint_lines.end()) dashes.back() = dashes_of(*paint);
  }
  return dashes;
}

HdMap surveyed_map(const HdMap& map, const MapDashes& dashes) {
  if (dashes.empty()) return map;
  assert(dashes.size() == map.elements.size());
  HdMap surveyed{map.name, map.origin, {}, map.lanes};
  for (size_t i = 0; i < dashes.size(); ++i) {
    const MapElement& element = map.elements[i];
    if (is_whole(dashes[i])) {
      surveyed.elements.push_back(element);
      continue;
    }
    const DashedLine line = dashed_line(element.points, dashes[i]);
    for (const PointRange& dash : painted_stretches(line.painted)) {
      const auto points = std::span(line.points).subspan(dash.first, dash.last - dash.first + 1);
      surveyed.elements.push_back(
          {element.element_class, element.appearance, {points.begin(), points.end()}});
    }
  }
  return surveyed;
}

}  // namespace bevloc::sim
