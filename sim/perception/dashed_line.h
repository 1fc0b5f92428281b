// Lines of which only some stretches are painted.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace bevloc::sim {

/// A painted stretch of a line, from one station (metres along the line) to another.
struct Dash {
  double from_m;
  double to_m;
};

/// A line painted from end to end.
inline constexpr Dash kWholeLine{0.0, std::numeric_limits<double>::infinity()};

/// For each element of a map its dashes, in order and apart (kWholeLine alone for an element that
/// is one whole; none for one that is not painted anywhere). Empty: every element is one whole.
using MapDashes = std::vector<std::vector<Dash>>;

struct DashedLine {
  std::vector<Eigen::Vector2d> points;
  std::vector<bool> painted;  ///< of each piece between two points: one less than points
};

/// The polyline with points added where its dashes begin and end.
DashedLine dashed_line(const std::vector<Eigen::Vector2d>& line, std::span<const Dash> dashes);

/// Points of a line, the last one included.
struct PointRange {
  size_t first;
  size_t last;
};

/// The stretches that are painted throughout, each as long as possible.
std::vector<PointRange> painted_stretches(const std::vector<bool>& painted);

}  // namespace bevloc::sim
