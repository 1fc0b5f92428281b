#include "sim/perception/road_kind.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/bev_grid.h"
#include "sim/perception/visible_lines.h"
#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

/// The box at the prior exceeds the box at the true pose by at most this.
constexpr double kRim_m = 3.0;

// If the lines are shorter than this in all, there is nothing to match.
constexpr double kLeastLine_m = 40.0;
constexpr double kLongLine_m = 20.0;
constexpr double kStraightRoad_m = 35.0;
// Elements meet with offsets of a few centimetres, so shorter pieces have no useful direction.
constexpr double kPiece_m = 2.0;

constexpr double kStraight_rad = radians(3.0);
constexpr double kParallel_rad = radians(1.0);
constexpr double kStraight_m = 0.15;  ///< largest lateral deviation of a straight line
constexpr double kCurve_rad = radians(10.0);
constexpr double kBend_rad = radians(20.0);

// A corner is a kerb that turns by at least this angle within a few metres. The ends of parking
// bays turn by 40 degrees and back, roads bend more gently, and the round end of a median belongs
// to a ring.
constexpr double kCorner_rad = radians(50.0);
constexpr double kSharpCorner_m = 11.0;
constexpr double kWideCorner_m = 25.0;
constexpr double kStraightPart_m = 10.0;

// The island of a roundabout shows a large part of its circle.
constexpr double kIsland_rad = radians(120.0);
constexpr double kSmallestIsland_m = 4.5;
constexpr double kIslandWindow_m = 6.0;

// The taper of a lane is a slight S that shifts by most of a lane's width.
constexpr double kTaperLeast_rad = radians(2.5);
constexpr double kTaperMost_rad = radians(18.0);
constexpr double kTaperShift_m = 2.2;

/// The heading along a line, without jumps of 2 pi.
struct Course {
  const VisibleLine* line;
  std::vector<double> station_m;  ///< end of each piece
  std::vector<double> heading_rad;
  double length_m = 0.0;

  double turn_rad() const {
    const auto [low, high] = std::minmax_element(heading_rad.begin(), heading_rad.end());
    return *high - *low;
  }
};

Course course_of(const VisibleLine& line) {
  Course course{.line = &line, .station_m = {}, .heading_rad = {}};
  Eigen::Vector2d from = line.points.front();
  for (size_t i = 1; i < line.points.size(); ++i) {
    const Eigen::Vector2d step = line.points[i] - from;
    const double piece_m = step.norm();
    if (piece_m < kPiece_m) continue;
    double heading = std::atan2(step.y(), step.x());
    if (!course.heading_rad.empty()) {
      const double before = course.heading_rad.back();
      heading = before + wrap_angle(heading - before);
    }
    course.length_m += piece_m;
    course.station_m.push_back(course.length_m);
    course.heading_rad.push_back(heading);
    from = line.points[i];
  }
  return course;
}

/// The largest turn between two places of a course at most `within_m` apart.
double sharpest_turn(const Course& course, double within_m) {
  double sharpest = 0.0;
  for (size_t i = 0; i < course.station_m.size(); ++i) {
    for (size_t k = i + 1; k < course.station_m.size(); ++k) {
      if (course.station_m[k] - course.station_m[i] > within_m) break;
      sharpest = std::max(sharpest, std::abs(course.heading_rad[k] - course.heading_rad[i]));
    }
  }
  return sharpest;
}

/// Whether the course is an arc of a circle: it turns evenly, and less tightly than the end of a
/// median.
bool is_island(const Course& course) {
  if (!course.line->of_ring) return false;
  const double turn = course.turn_rad();
  const double sharpest = sharpest_turn(course, kIslandWindow_m);
  return turn > kIsland_rad && sharpest < kIslandWindow_m / kSmallestIsland_m &&
         sharpest < 1.5 * turn * kIslandWindow_m / course.length_m;
}

bool is_open_kerb(const Course& course) {
  return course.line->element_class == ElementClass::kRoadBoundary && !course.line->of_ring;
}

bool is_crossing(const VisibleLine& line) {
  return line.element_class == ElementClass::kPedestrianCrossing;
}

/// Whether a kerb turns sharply, or less sharply while another line goes straight on.
bool has_corner(const std::vector<Course>& courses) {
  const bool goes_straight_on =
      std::any_of(courses.begin(), courses.end(), [](const Course& course) {
        return !is_crossing(*course.line) && !course.line->of_ring &&
               course.length_m > kStraightPart_m && course.turn_rad() < kStraight_rad;
      });
  const double within_m = goes_straight_on ? kWideCorner_m : kSharpCorner_m;
  return std::any_of(courses.begin(), courses.end(), [&](const Course& course) {
    return is_open_kerb(course) && sharpest_turn(course, within_m) > kCorner_rad;
  });
}

/// Whether a kerb turns slightly and back again, and so shifts outwards or inwards by a lane.
bool is_taper(const Course& course) {
  if (!is_open_kerb(course)) return false;
  const double first = course.heading_rad.front();
  const double last = course.heading_rad.back();
  if (std::abs(last - first) > kStraight_rad) return false;
  const double along = 0.5 * (first + last);
  double most = 0.0;
  for (const double heading : course.heading_rad) most = std::max(most, std::abs(heading - along));
  const auto& points = course.line->points;
  const double shift_m = cross(unit_vector(along), points.back() - points.front());
  return most > kTaperLeast_rad && most < kTaperMost_rad && std::abs(shift_m) > kTaperShift_m;
}

Eigen::Vector2d chord(const VisibleLine& line) {
  return (line.points.back() - line.points.front()).normalized();
}

/// Whether all points lie close to the straight between the line's ends.
bool is_straight(const VisibleLine& line) {
  const Eigen::Vector2d along = chord(line);
  return std::all_of(line.points.begin(), line.points.end(), [&](const Eigen::Vector2d& point) {
    return std::abs(cross(along, point - line.points.front())) < kStraight_m;
  });
}

bool are_parallel(const VisibleLine& a, const VisibleLine& b) {
  return std::abs(cross(chord(a), chord(b))) < std::sin(kParallel_rad);
}

/// Whether the scene looks the same from everywhere along the road.
bool is_uniform(const std::vector<VisibleLine>& lines) {
  return std::all_of(lines.begin(), lines.end(), [&](const VisibleLine& line) {
    return !is_crossing(line) && !line.begins && !line.ends && is_straight(line) &&
           are_parallel(line, lines.front());
  });
}

/// Whether the point is inside the box at every prior.
bool is_well_inside(const Eigen::Vector2d& point) {
  return std::abs(point.x()) < kRasterGrid.x_range_m() - kRim_m &&
         std::abs(point.y()) < kRasterGrid.y_range_m() - kRim_m;
}

/// Whether the line bends at a point, as at the end of a parking bay or of a median.
bool bends_at(const VisibleLine& line, size_t point) {
  constexpr size_t kReach = 6;  // points, half a metre apart or less
  if (point < kReach || point + kReach >= line.points.size()) return false;
  const Eigen::Vector2d in = line.points[point] - line.points[point - kReach];
  const Eigen::Vector2d out = line.points[point + kReach] - line.points[point];
  return in.dot(out) < std::cos(kBend_rad) * in.norm() * out.norm();
}

/// Whether something well within the box gives evidence along the road.
bool has_structure(const std::vector<VisibleLine>& lines) {
  return std::any_of(lines.begin(), lines.end(), [](const VisibleLine& line) {
    for (size_t i = 0; i < line.points.size(); ++i) {
      const bool is_end = (line.begins && i == 0) || (line.ends && i + 1 == line.points.size());
      if (!is_crossing(line) && !is_end && !bends_at(line, i)) continue;
      if (is_well_inside(line.points[i])) return true;
    }
    return false;
  });
}

/// The kind of a road that is uniform except for dashes.
std::optional<RoadKind> kind_by_dashes(const std::vector<VisibleLine>& lines) {
  bool has_dashes = false;
  for (const VisibleLine& line : lines) {
    for (size_t i = 1; i < line.painted.size(); ++i) {
      if (line.painted[i] == line.painted[i - 1]) continue;
      has_dashes = true;
      if (is_well_inside(line.points[i])) return RoadKind::kStraightStructured;
    }
  }
  return has_dashes ? std::nullopt : std::optional(RoadKind::kStraightSolid);
}

/// Statistics of the bends of all long lines.
struct Bends {
  int lines = 0;
  double longest_straight_m = 0.0;
  double least_from_end_to_end_rad = std::numbers::pi;
  double most_from_end_to_end_rad = 0.0;
  bool straight_through = false;  ///< a straight line runs through the whole box
  bool taper = false;
};

Bends bends_of(const std::vector<Course>& courses) {
  Bends bends;
  for (const Course& course : courses) {
    const VisibleLine& line = *course.line;
    if (is_crossing(line) || line.of_ring || course.length_m < kLongLine_m) continue;
    const double from_end_to_end = std::abs(course.heading_rad.back() - course.heading_rad.front());
    ++bends.lines;
    bends.least_from_end_to_end_rad = std::min(bends.least_from_end_to_end_rad, from_end_to_end);
    bends.most_from_end_to_end_rad = std::max(bends.most_from_end_to_end_rad, from_end_to_end);
    bends.taper = bends.taper || is_taper(course);
    if (course.turn_rad() > kStraight_rad) continue;
    bends.longest_straight_m = std::max(bends.longest_straight_m, course.length_m);
    bends.straight_through = bends.straight_through || (!line.begins && !line.ends);
  }
  return bends;
}

/// The kind of a road without corners.
std::optional<RoadKind> kind_between_junctions(const std::vector<VisibleLine>& lines,
                                               const std::vector<Course>& courses) {
  const Bends bends = bends_of(courses);
  if (bends.taper && bends.straight_through) return RoadKind::kMergeOrRoundabout;
  if (bends.lines < 2) return std::nullopt;
  if (bends.least_from_end_to_end_rad > kCurve_rad) return RoadKind::kCurve;
  if (bends.longest_straight_m > kStraightRoad_m &&
      bends.most_from_end_to_end_rad < kStraight_rad && has_structure(lines)) {
    return RoadKind::kStraightStructured;
  }
  return std::nullopt;
}

}  // namespace

const char* name(RoadKind kind) {
  switch (kind) {
    case RoadKind::kStraightSolid:
      return "straight_solid";
    case RoadKind::kStraightStructured:
      return "straight_structured";
    case RoadKind::kCurve:
      return "curve";
    case RoadKind::kJunction:
      return "junction";
    case RoadKind::kMergeOrRoundabout:
      return "merge_or_roundabout";
  }
  return "";
}

std::optional<RoadKind> road_kind(const MapIndex& index, const Se2& map_from_vehicle,
                                  const MapDashes& dashes) {
  const std::vector<VisibleLine> lines = visible_lines(index, map_from_vehicle, 0.0);
  std::vector<Course> courses;
  double length_m = 0.0;
  for (const VisibleLine& line : lines) {
    Course course = course_of(line);
    if (course.heading_rad.empty()) continue;
    length_m += course.length_m;
    courses.push_back(std::move(course));
  }
  if (length_m < kLeastLine_m) return std::nullopt;
  if (is_uniform(visible_lines(index, map_from_vehicle, kRim_m))) {
    return kind_by_dashes(visible_lines(index, map_from_vehicle, kRim_m, dashes));
  }
  if (std::any_of(courses.begin(), courses.end(), is_island)) return RoadKind::kMergeOrRoundabout;
  if (has_corner(courses)) return RoadKind::kJunction;
  return kind_between_junctions(lines, courses);
}

}  // namespace bevloc::sim
