// Lines with dashes: which stretches of a line are painted.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace bevloc::sim {

/// A painted stretch of a line, as stations (metres along the line).
struct Dash {
  double from_m;
  double to_m;
};

/// A line painted from end to end.
inline constexpr Dash kWholeLine{0.0, std::numeric_limits<double>::infinity()};

/// The dashes of each element of a map, sorted and not overlapping. A continuous element has
/// kWholeLine, an unpainted one has no dash. If the vector is empty, every element is continuous.
using MapDashes = std::vector<std::vector<Dash>>;

/// A polyline whose segments are painted or not.
struct DashedLine {
  std::vector<Eigen::Vector2d> points;
  std::vector<bool> painted;  ///< per segment: one element less than points
};

/// Adds points to the polyline where dashes begin and end.
DashedLine dashed_line(const std::vector<Eigen::Vector2d>& line, std::span<const Dash> dashes);

/// A range of points, including `last`.
struct PointRange {
  size_t first;
  size_t last;
};

/// The longest possible stretches that are painted without a gap.
std::vector<PointRange> painted_stretches(const std::vector<bool>& painted);

}  // namespace bevloc::sim
