#include "sim/samples/map_habits.h"

#include <algorithm>

#include "sim/random.h"
#include "sim/world/path.h"
#include "sim/world/road_side.h"

namespace bevloc::sim {
namespace {

/// Shorter pieces of a line are left out.
constexpr double kShortestPiece_m = 3.0;

/// The range from which the length or the distance of a habit is drawn.
struct Extent {
  double least_m;
  double most_m;
};
constexpr Extent kShortDivider{5.0, 30.0};
constexpr Extent kLongDivider{5.0, 20.0};
constexpr Extent kBrokenDivider{10.0, 40.0};
constexpr Extent kInnerBoundary{0.1, 0.7};
constexpr Extent kClosedMouth{5.0, 20.0};
constexpr Extent kSecondBoundary{0.5, 4.0};

double drawn(const Extent& extent, Random& random) {
  return random.uniform(extent.least_m, extent.most_m);
}

/// By how much each end of a line moves; positive values lengthen the line.
struct EndChanges {
  double begin_m = 0.0;
  double end_m = 0.0;
};

/// The part of a path between two stations; beyond the ends it continues straight.
Polyline part_of(const Path& path, double from_m, double to_m) {
  return path.parallel(from_m, to_m, 0.0);
}

/// Redraws the elements of one map.
class Surveyor {
 public:
  Surveyor(const HdMap& map, const MapHabits& habits, uint64_t seed)
      : habits_(habits), road_(map), random_(seed_for(seed, "map habits")) {}

  std::vector<MapElement> redraw(const std::vector<MapElement>& elements) {
    for (const MapElement& element : elements) {
      const bool is_line = element.element_class != ElementClass::kPedestrianCrossing &&
                           element.points.size() >= 2 &&
                           polyline_length(element.points) >= kShortestPiece_m;
      if (!is_line) {
        redrawn_.push_back(element);
      } else if (element.element_class == ElementClass::kLaneDivider) {
        redraw_divider(element);
      } else {
        redraw_boundary(element);
      }
    }
    return std::move(redrawn_);
  }

 private:
  void redraw_divider(const MapElement& element) {
    const EndChanges ends{divider_end(), divider_end()};
    const bool is_broken = random_.chance(habits_.broken_divider);
    const double gap_m = drawn(kBrokenDivider, random_);
    const double middle = random_.uniform();
    const Path path(element.points);
    const double begin_m = -ends.begin_m;
    const double end_m = path.length_m() + ends.end_m;
    if (!is_broken) {
      add(element, path, begin_m, end_m);
      return;
    }
    const double gap_begin_m = begin_m + middle * (end_m - begin_m) - 0.5 * gap_m;
    add(element, path, begin_m, gap_begin_m);
    add(element, path, gap_begin_m + gap_m, end_m);
  }

  double divider_end() {
    const bool is_short = random_.chance(habits_.short_divider);
    const bool is_long = random_.chance(habits_.long_divider);
    const double shorter_m = drawn(kShortDivider, random_);
    const double longer_m = drawn(kLongDivider, random_);
    if (is_short) return -shorter_m;
    return is_long ? longer_m : 0.0;
  }

  void redraw_boundary(const MapElement& element) {
    const EndChanges ends{boundary_end(), boundary_end()};
    const bool is_inside = random_.chance(habits_.inner_boundary);
    const double inside_m = drawn(kInnerBoundary, random_);
    const bool is_double = random_.chance(habits_.double_boundary);
    const double outside_m = drawn(kSecondBoundary, random_);
    const Path path(element.points);
    const auto side = road_.of(path);
    const double inwards = side && side->is_right ? 1.0 : -1.0;
    if (is_inside && side) {
      add(element, Path(path.parallel(0.0, path.length_m(), inwards * inside_m)), ends);
    } else {
      add(element, path, ends);
    }
    if (is_double && side) {
      add(element, Path(path.parallel(0.0, path.length_m(), -inwards * outside_m)), EndChanges());
    }
  }

  double boundary_end() {
    const bool is_closed = random_.chance(habits_.closed_mouth);
    const double longer_m = drawn(kClosedMouth, random_);
    return is_closed ? longer_m : 0.0;
  }

  void add(const MapElement& element, const Path& path, const EndChanges& ends) {
    add(element, path, -ends.begin_m, path.length_m() + ends.end_m);
  }

  void add(const MapElement& element, const Path& path, double from_m, double to_m) {
    if (to_m - from_m < kShortestPiece_m) return;
    redrawn_.push_back({element.element_class, element.appearance, part_of(path, from_m, to_m)});
  }

  MapHabits habits_;
  RoadSide road_;
  Random random_;
  std::vector<MapElement> redrawn_;
};

}  // namespace

MapHabits scaled(const MapHabits& habits, double factor) {
  const auto share = [factor](double value) { return std::min(factor * value, 1.0); };
  return {.short_divider = share(habits.short_divider),
          .long_divider = share(habits.long_divider),
          .broken_divider = share(habits.broken_divider),
          .inner_boundary = share(habits.inner_boundary),
          .closed_mouth = share(habits.closed_mouth),
          .double_boundary = share(habits.double_boundary)};
}

HdMap with_habits(const HdMap& map, const MapHabits& habits, uint64_t seed) {
  if (habits == MapHabits{}) return map;
  HdMap redrawn = map;
  redrawn.elements = Surveyor(map, habits, seed).redraw(map.elements);
  return redrawn;
}

}  // namespace bevloc::sim
