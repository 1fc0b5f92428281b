#include "sim/world/paving.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

constexpr double kShortestPavedLane_m = 0.3;
constexpr double kReach_m = 6.0;
constexpr double kShoulder_m = 0.3;
constexpr double kStripStep_m = 1.0;
/// Lines that are closer are the same line.
constexpr double kSame_m = 0.05;
constexpr double kLineCell_m = 8.0;

struct Segment {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  size_t lane;  ///< index of the lane that it bounds, or kNoLane
};
constexpr size_t kNoLane = static_cast<size_t>(-1);

/// The distance along the unit vector `ray` from `origin` at which it meets the segment.
std::optional<double> distance_to(const Segment& segment, const Eigen::Vector2d& origin,
                                  const Eigen::Vector2d& ray) {
  const Eigen::Vector2d along = segment.to - segment.from;
  const double sine = cross(ray, along);
  if (std::abs(sine) < 1e-9) return std::nullopt;
  const Eigen::Vector2d to_segment = segment.from - origin;
  const double place = cross(to_segment, ray) / sine;
  if (place < 0.0 || place > 1.0) return std::nullopt;
  return cross(to_segment, along) / sine;
}

/// The lines at which asphalt can end: the map's boundaries, and the bounds of all lanes.
class EndLines {
 public:
  explicit EndLines(const HdMap& map) {
    for (const MapElement& element : map.elements) {
      if (element.element_class == ElementClass::kRoadBoundary) add(element.points, kNoLane);
    }
    for (size_t lane = 0; lane < map.lanes.size(); ++lane) {
      add(map.lanes[lane].left, lane);
      add(map.lanes[lane].right, lane);
    }
  }

  /// The distance to the first line that the ray meets within reach, except those of `lane`.
  std::optional<double> first_along(const Eigen::Vector2d& origin, const Eigen::Vector2d& ray,
                                    size_t lane) const {
    std::optional<double> first;
    const Eigen::Vector2d end = origin + kReach_m * ray;
    for (int64_t east = cell_of(std::min(origin.x(), end.x()));
         east <= cell_of(std::max(origin.x(), end.x())); ++east) {
      for (int64_t north = cell_of(std::min(origin.y(), end.y()));
           north <= cell_of(std::max(origin.y(), end.y())); ++north) {
        const auto cell = cells_.find(key_of(east, north));
        if (cell == cells_.end()) continue;
        for (const size_t index : cell->second) {
          const Segment& segment = segments_[index];
          if (segment.lane == lane) continue;
          const auto distance_m = distance_to(segment, origin, ray);
          if (!distance_m || *distance_m < 0.0 || *distance_m > kReach_m) continue;
          if (!first || *distance_m < *first) first = distance_m;
        }
      }
    }
    return first;
  }

 private:
  static int64_t cell_of(double coordinate_m) {
    return static_cast<int64_t>(std::floor(coordinate_m / kLineCell_m));
  }
  static uint64_t key_of(int64_t east, int64_t north) {
    return (static_cast<uint64_t>(east) << 32U) ^ static_cast<uint32_t>(north);
  }

  void add(const Polyline& line, size_t lane) {
    for (size_t i = 0; i + 1 < line.size(); ++i) {
      const Segment segment{line[i], line[i + 1], lane};
      const Eigen::Vector2d low = segment.from.cwiseMin(segment.to);
      const Eigen::Vector2d high = segment.from.cwiseMax(segment.to);
      for (int64_t east = cell_of(low.x()); east <= cell_of(high.x()); ++east) {
        for (int64_t north = cell_of(low.y()); north <= cell_of(high.y()); ++north) {
          cells_[key_of(east, north)].push_back(segments_.size());
        }
      }
      segments_.push_back(segment);
    }
  }

  std::vector<Segment> segments_;
  std::unordered_map<uint64_t, std::vector<size_t>> cells_;  ///< indices of segments
};

/// Paves outwards from one bound of a lane, to the right of `bound`.
class StripPaver {
 public:
  StripPaver(const EndLines& ends, size_t lane, std::vector<Ring>& rings)
      : ends_(ends), lane_(lane), rings_(rings) {}

  void pave(const Path& bound) {
    const auto steps = std::max(1, static_cast<int>(std::ceil(bound.length_m() / kStripStep_m)));
    for (int step = 0; step <= steps; ++step) {
      const double station_m = bound.length_m() * step / steps;
      const double width_m = width_at(bound, station_m);
      if (width_m <= kSame_m) {
        finish();
        continue;
      }
      inner_.push_back(bound.position(station_m));
      outer_.push_back(bound.beside(station_m, width_m));
    }
    finish();
  }

 private:
  double width_at(const Path& bound, double station_m) const {
    const Eigen::Vector2d outwards = -left_of(bound.direction(station_m));
    const Eigen::Vector2d start = bound.beside(station_m, -kSame_m);
    const auto distance_m = ends_.first_along(start, outwards, lane_);
    return distance_m ? *distance_m - kSame_m : kShoulder_m;
  }

  void finish() {
    if (inner_.size() >= 2) {
      append(inner_, reversed(outer_));
      rings_.push_back(inner_);
    }
    inner_.clear();
    outer_.clear();
  }

  const EndLines& ends_;
  size_t lane_;
  std::vector<Ring>& rings_;
  Polyline inner_;
  Polyline outer_;
};

}  // namespace

std::vector<Ring> paved_rings(const HdMap& map) {
  const EndLines ends(map);
  std::vector<Ring> rings;
  for (size_t index = 0; index < map.lanes.size(); ++index) {
    const Lane& lane = map.lanes[index];
    if (polyline_length(lane.left) < kShortestPavedLane_m ||
        polyline_length(lane.right) < kShortestPavedLane_m)
      continue;
    Ring surface = lane.left;
    append(surface, reversed(lane.right));
    rings.push_back(std::move(surface));
    StripPaver paver(ends, index, rings);
    paver.pave(Path(reversed(lane.left)));
    paver.pave(Path(lane.right));
  }
  return rings;
}

}  // namespace bevloc::sim
