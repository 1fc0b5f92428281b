#include "pipeline/map/lanelet_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/median.h"

namespace bevloc {
namespace {

std::vector<double> arc_lengths(const Polyline& line) {
  std::vector<double> lengths(line.size(), 0.0);
  for (size_t i = 1; i < line.size(); ++i) {
    lengths[i] = lengths[i - 1] + (line[i] - line[i - 1]).norm();
  }
  return lengths;
}

/// The point at a fraction (0 to 1) of a polyline's length.
Eigen::Vector2d point_at(const Polyline& line, const std::vector<double>& lengths,
                         double fraction) {
  const double length = fraction * lengths.back();
  const auto next = std::lower_bound(lengths.begin() + 1, lengths.end() - 1, length);
  const auto i = static_cast<size_t>(next - lengths.begin());
  const double step = lengths[i] - lengths[i - 1];
  const double along = step > 0.0 ? std::clamp((length - lengths[i - 1]) / step, 0.0, 1.0) : 0.0;
  return line[i - 1] + along * (line[i] - line[i - 1]);
}

/// Whether a point lies to the left of the nearest segment of a polyline.
bool is_left_of(const Eigen::Vector2d& point, const Polyline& line) {
  double nearest = std::numeric_limits<double>::infinity();
  double side = 0.0;
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    const double distance = distance_to_segment(point, line[i], line[i + 1]);
    if (distance >= nearest) continue;
    nearest = distance;
    side = cross(line[i + 1] - line[i], point - line[i]);
  }
  return side > 0.0;
}

Eigen::Vector2d middle_of(const Polyline& line) {
  return point_at(line, arc_lengths(line), 0.5);
}

/// Douglas-Peucker algorithm: marks the points between two kept ones that remain. `last` may be
/// the size of the line, which stands for its first point.
void mark_kept(const Polyline& line, size_t first, size_t last, double tolerance_m,
               std::vector<bool>& kept) {
  const auto at = [&line](size_t i) -> const Eigen::Vector2d& { return line[i % line.size()]; };
  std::vector<std::pair<size_t, size_t>> open{{first, last}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    double worst_m = tolerance_m;
    size_t split = from;
    for (size_t i = from + 1; i < to; ++i) {
      const double distance_m = distance_to_segment(at(i), at(from), at(to));
      if (distance_m <= worst_m) continue;
      worst_m = distance_m;
      split = i;
    }
    if (split == from) continue;
    kept[split % line.size()] = true;
    open.emplace_back(from, split);
    open.emplace_back(split, to);
  }
}

size_t farthest_from(const Eigen::Vector2d& point, const Polyline& line) {
  const auto farthest = std::ranges::max_element(
      line, {}, [&point](const Eigen::Vector2d& other) { return (other - point).squaredNorm(); });
  return static_cast<size_t>(farthest - line.begin());
}

std::vector<size_t> indices_of(const std::vector<bool>& marked) {
  std::vector<size_t> indices;
  for (size_t i = 0; i < marked.size(); ++i) {
    if (marked[i]) indices.push_back(i);
  }
  return indices;
}

/// The points of a ring that lie more than 0.3 m beside the line between two others.
std::vector<size_t> without_straight(const Polyline& ring) {
  constexpr double kTolerance_m = 0.3;
  std::vector<bool> kept(ring.size(), false);
  // The point that is farthest from any other one is a corner, which the first point need not be.
  size_t first = farthest_from(ring.front(), ring);
  size_t second = farthest_from(ring[first], ring);
  if (first > second) std::swap(first, second);
  kept[first] = kept[second] = true;
  mark_kept(ring, first, second, kTolerance_m, kept);
  mark_kept(ring, second, first + ring.size(), kTolerance_m, kept);
  return indices_of(kept);
}

/// Pieces of a line whose ends are closer than this belong together.
constexpr double kJoint_m = 0.2;

/// Adds a piece to the chain, at the end of the chain that it meets. Returns false if it meets
/// neither end.
bool attach(const Polyline& piece, Polyline& chain) {
  const auto meet = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a - b).norm() <= kJoint_m;
  };
  if (meet(chain.back(), piece.front())) {
    chain.insert(chain.end(), piece.begin() + 1, piece.end());
  } else if (meet(chain.back(), piece.back())) {
    chain.insert(chain.end(), piece.rbegin() + 1, piece.rend());
  } else if (meet(chain.front(), piece.back())) {
    chain.insert(chain.begin(), piece.begin(), piece.end() - 1);
  } else if (meet(chain.front(), piece.front())) {
    chain.insert(chain.begin(), piece.rbegin(), piece.rend() - 1);
  } else {
    return false;
  }
  return true;
}

}  // namespace

std::optional<Polyline> joined(std::vector<Polyline> pieces) {
  Polyline chain = std::move(pieces.front());
  pieces.erase(pieces.begin());
  while (!pieces.empty()) {
    const auto next = std::ranges::find_if(
        pieces, [&chain](const Polyline& piece) { return attach(piece, chain); });
    if (next == pieces.end()) return std::nullopt;
    pieces.erase(next);
  }
  return chain;
}

void align_bounds(Polyline& left, Polyline& right) {
  const bool left_runs_backwards = is_left_of(middle_of(right), left);
  const bool right_runs_backwards = !is_left_of(middle_of(left), right);
  if (left_runs_backwards) std::reverse(left.begin(), left.end());
  if (right_runs_backwards) std::reverse(right.begin(), right.end());
}

Polyline centerline_between(const Polyline& left, const Polyline& right) {
  constexpr double kMaxStepM = 2.0;
  const std::vector<double> left_lengths = arc_lengths(left);
  const std::vector<double> right_lengths = arc_lengths(right);
  const double length = std::max(left_lengths.back(), right_lengths.back());
  const auto steps = static_cast<size_t>(std::max(1.0, std::ceil(length / kMaxStepM)));
  Polyline centerline;
  for (size_t i = 0; i <= steps; ++i) {
    const double fraction = static_cast<double>(i) / static_cast<double>(steps);
    centerline.emplace_back(
        0.5 * (point_at(left, left_lengths, fraction) + point_at(right, right_lengths, fraction)));
  }
  return centerline;
}

Eigen::Vector2d median_point(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d middle;
  std::vector<double> values;
  for (int axis = 0; axis < 2; ++axis) {
    values.clear();
    for (const Eigen::Vector2d& point : points) values.push_back(point[axis]);
    middle[axis] = median(values);
  }
  return middle;
}

double length_of(const MapElement& element) {
  double length_m = 0.0;
  for (size_t i = 0; i < segment_count(element); ++i) {
    length_m += (segment_end(element, i) - element.points[i]).norm();
  }
  return length_m;
}

double area_of_ring_m2(const Polyline& ring) {
  double twice_m2 = 0.0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d a = ring[i] - ring.front();
    const Eigen::Vector2d b = ring[(i + 1) % ring.size()] - ring.front();
    twice_m2 += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice_m2);
}

std::vector<size_t> kept_points(const Polyline& line, double tolerance_m) {
  if (line.empty()) return {};
  std::vector<bool> kept(line.size(), false);
  kept.front() = kept.back() = true;
  mark_kept(line, 0, line.size() - 1, tolerance_m, kept);
  return indices_of(kept);
}

std::vector<size_t> corners_of_ring(const Polyline& ring) {
  std::vector<size_t> corners(ring.size());
  std::iota(corners.begin(), corners.end(), size_t{0});
  Polyline rest = ring;
  // Repeats this until nothing changes, so that a map that is written and read again stays the
  // same.
  while (rest.size() > 3) {
    const std::vector<size_t> kept = without_straight(rest);
    if (kept.size() < 3 || kept.size() == rest.size()) break;
    for (size_t i = 0; i < kept.size(); ++i) {
      corners[i] = corners[kept[i]];
      rest[i] = rest[kept[i]];
    }
    corners.resize(kept.size());
    rest.resize(kept.size());
  }
  return corners;
}

Polyline ring_between(const Polyline& left, const Polyline& right) {
  Polyline ring = left;
  Polyline back = right;
  const double same_way =
      (left.front() - right.front()).norm() + (left.back() - right.back()).norm();
  const double opposite_way =
      (left.front() - right.back()).norm() + (left.back() - right.front()).norm();
  if (same_way < opposite_way) std::reverse(back.begin(), back.end());
  for (const Eigen::Vector2d& point : back) {
    if (point != ring.back() && point != ring.front()) ring.push_back(point);
  }
  Polyline corners;
  for (const size_t i : corners_of_ring(ring)) corners.push_back(ring[i]);
  return corners;
}

Lane reversed(const Lane& lane) {
  Lane other = lane;
  std::swap(other.left, other.right);
  for (Polyline* line : {&other.left, &other.right, &other.centerline}) {
    std::reverse(line->begin(), line->end());
  }
  return other;
}

void link_successors(std::vector<Lane>& lanes) {
  constexpr double kSamePlaceM = 0.1;
  std::vector<uint32_t> by_start(lanes.size());
  std::iota(by_start.begin(), by_start.end(), 0U);
  const auto start_x = [&lanes](uint32_t lane) { return lanes[lane].left.front().x(); };
  std::sort(by_start.begin(), by_start.end(), [&start_x](uint32_t a, uint32_t b) {
    return std::pair(start_x(a), a) < std::pair(start_x(b), b);
  });
  for (Lane& lane : lanes) {
    const Eigen::Vector2d& left_end = lane.left.back();
    const Eigen::Vector2d& right_end = lane.right.back();
    auto candidate =
        std::lower_bound(by_start.begin(), by_start.end(), left_end.x() - kSamePlaceM,
                         [&start_x](uint32_t other, double x) { return start_x(other) < x; });
    for (; candidate != by_start.end() && start_x(*candidate) <= left_end.x() + kSamePlaceM;
         ++candidate) {
      const Lane& next = lanes[*candidate];
      if ((next.left.front() - left_end).norm() <= kSamePlaceM &&
          (next.right.front() - right_end).norm() <= kSamePlaceM) {
        lane.successors.push_back(*candidate);
      }
    }
    std::sort(lane.successors.begin(), lane.successors.end());
  }
}

}  // namespace bevloc
