#include "pipeline/map/formats/opendrive/section_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace bevloc::opendrive {
namespace {

constexpr double kSpacing_m = 0.5;

/// The places where a formula changes, from start to end of a part of the section.
std::vector<double> changes_in(const Road& road, const LaneSection& section, const Stretch& part) {
  std::vector<double> at{part.start_m, part.end_m};
  for (const Geometry& geometry : road.geometries) at.push_back(geometry.start_m);
  for (const Cubics* cubics : {&road.lane_offsets, &road.elevations}) {
    for (const Cubic& cubic : *cubics) at.push_back(cubic.start_m);
  }
  for (const LaneSpec& lane : section.lanes) {
    for (const Cubics* cubics : {&lane.widths, &lane.borders}) {
      for (const Cubic& cubic : *cubics) at.push_back(section.start_m + cubic.start_m);
    }
    for (const RoadMark& mark : lane.marks) {
      const double mark_m = section.start_m + mark.start_m;
      at.push_back(mark_m);
      for (const Cubic& sway : mark.sways) at.push_back(mark_m + sway.start_m);
    }
  }
  std::erase_if(at, [&](double s) { return s < part.start_m || s > part.end_m; });
  std::ranges::sort(at);
  constexpr double kSamePlace_m = 1e-6;
  const auto is_same = [](double a, double b) { return b - a < kSamePlace_m; };
  at.erase(std::unique(at.begin(), at.end(), is_same), at.end());
  return at;
}

/// The values of s between the pieces of a part of a section.
std::vector<double> cuts_of(const Road& road, const LaneSection& section, const Stretch& part) {
  const std::vector<double> changes = changes_in(road, section, part);
  std::vector<double> cuts;
  for (size_t i = 0; i + 1 < changes.size(); ++i) {
    const double span_m = changes[i + 1] - changes[i];
    const auto pieces = static_cast<int>(std::max(1.0, std::ceil(span_m / kSpacing_m)));
    for (int piece = 0; piece < pieces; ++piece) {
      cuts.push_back(changes[i] + span_m * piece / pieces);
    }
  }
  if (!cuts.empty()) cuts.push_back(changes.back());
  return cuts;
}

/// The lateral position of the outer border of a lane, beyond `inner_m`. At the end of a part of
/// the section (`is_end`), formulas that begin there do not count.
double outer_border(const LaneSpec& lane, double along_m, double inner_m, double offset_m,
                    bool is_end) {
  const double side = lane.id > 0 ? 1.0 : -1.0;
  if (lane.widths.empty() && !lane.borders.empty()) {
    // Files disagree about the sign on the right side.
    return offset_m + side * std::abs(value_at(lane.borders, along_m, is_end));
  }
  return inner_m + side * std::max(0.0, value_at(lane.widths, along_m, is_end));
}

double height_at(const Road& road, double s_m, bool is_end = false) {
  if (road.elevations.empty()) return std::numeric_limits<double>::quiet_NaN();
  return value_at(road.elevations, s_m, is_end);
}

}  // namespace

double CutSection::width_m(size_t lane, size_t piece) const {
  return std::max(lines.lateral_m[lane + 1][piece] - lines.lateral_m[lane][piece],
                  lines.lateral_m[lane + 1][piece + 1] - lines.lateral_m[lane][piece + 1]);
}

std::pair<Eigen::Vector3d, Eigen::Vector3d> CutSection::paint(const RoadMark& mark, size_t border,
                                                              size_t piece) const {
  const auto end_of_paint = [&](size_t at, bool is_end) {
    Eigen::Vector3d point = lines.borders[border][at];
    const double along_m = lines.along_m[at] - section->start_m;
    point.head<2>() += mark.left_of_border_m(along_m, is_end) * lines.lefts[at];
    return point;
  };
  return {end_of_paint(piece, false), end_of_paint(piece + 1, true)};
}

std::string CutSection::type_from(std::ptrdiff_t lane, int step, size_t piece) const {
  for (; lane >= 0 && lane < std::ssize(section->lanes); lane += step) {
    const LaneSpec& spec = section->lanes[lane];
    if (spec.id != 0 && width_m(lane, piece) > kNoWidth_m) return spec.type;
  }
  return "none";
}

Stretch part_of(const LaneSection& section, const Stretch& stretch) {
  Stretch part{std::max(section.start_m, stretch.start_m), section.end_m};
  if (stretch.end_m <= section.end_m) {
    part.end_m = stretch.end_m;
    part.jump_m = stretch.jump_m;
  }
  return part;
}

std::vector<Outline> outlines_of(const RoadObject& object) {
  if (!object.outlines.empty()) return object.outlines;
  const double u = 0.5 * object.length_m;
  const double v = 0.5 * object.width_m;
  if (u <= 0.0 || v <= 0.0) return {Outline()};
  return {{{{true, {u, v, 0}}, {true, {-u, v, 0}}, {true, {-u, -v, 0}}, {true, {u, -v, 0}}}}};
}

Line3 points_of(const Road& road, const RoadObject& object, const Outline& outline) {
  const Eigen::Vector3d origin = point_at(road, object.s_m, object.t_m);
  const double heading = road.pose_at(object.s_m).heading_rad + object.heading_rad;
  const double c = std::cos(heading);
  const double s = std::sin(heading);
  Line3 points;
  for (const Corner& corner : outline.corners) {
    if (corner.is_local) {
      points.emplace_back(origin.x() + c * corner.place.x() - s * corner.place.y(),
                          origin.y() + s * corner.place.x() + c * corner.place.y(),
                          origin.z() + object.z_m + corner.place.z());
    } else {
      points.push_back(point_at(road, corner.place.x(), corner.place.y()));
      points.back().z() += corner.place.z();
    }
  }
  return outline.is_closed ? closed(std::move(points)) : points;
}

Eigen::Vector3d point_at(const Road& road, double s_m, double t_m) {
  const LinePose pose = road.pose_at(s_m);
  return {pose.position.x() - t_m * std::sin(pose.heading_rad),
          pose.position.y() + t_m * std::cos(pose.heading_rad), height_at(road, s_m)};
}

SectionLines lines_of(const Road& road, const LaneSection& section, const Stretch& part) {
  SectionLines lines;
  lines.along_m = cuts_of(road, section, part);
  const auto center = static_cast<size_t>(std::ranges::find(section.lanes, 0, &LaneSpec::id) -
                                          section.lanes.begin());
  const size_t count = section.lanes.size() + 1;
  lines.borders.resize(count);
  lines.lateral_m.resize(count);
  std::vector<double> lateral(count);
  for (const double s : lines.along_m) {
    const bool is_end = s == lines.along_m.back();
    const double along_m = s - section.start_m;
    const double offset_m = value_at(road.lane_offsets, s, is_end);
    lateral[center] = lateral[center + 1] = offset_m;
    for (size_t lane = center; lane-- > 0;) {
      lateral[lane] =
          outer_border(section.lanes[lane], along_m, lateral[lane + 1], offset_m, is_end);
    }
    for (size_t lane = center + 1; lane < section.lanes.size(); ++lane) {
      lateral[lane + 1] =
          outer_border(section.lanes[lane], along_m, lateral[lane], offset_m, is_end);
    }
    const LinePose pose = road.pose_at(s, part.jump_m > 0.0 && is_end);
    lines.lefts.emplace_back(-std::sin(pose.heading_rad), std::cos(pose.heading_rad));
    const double height_m = height_at(road, s, is_end);
    for (size_t border = 0; border < count; ++border) {
      const Eigen::Vector2d point = pose.position + lateral[border] * lines.lefts.back();
      lines.borders[border].emplace_back(point.x(), point.y(), height_m);
      lines.lateral_m[border].push_back(lateral[border]);
    }
  }
  return lines;
}

bool is_driven(std::string_view lane_type) {
  static constexpr std::array<std::string_view, 14> kTypes{
      "driving",  "entry", "exit", "onRamp", "offRamp",  "connectingRamp", "bidirectional",
      "slipLane", "bus",   "taxi", "HOV",    "mwyEntry", "mwyExit",        "special1"};
  return std::ranges::find(kTypes, lane_type) != kTypes.end();
}

bool is_paved(std::string_view lane_type) {
  static constexpr std::array<std::string_view, 10> kTypes{
      "shoulder", "parking", "biking",    "stop",     "restricted",
      "tram",     "rail",    "roadWorks", "special2", "special3"};
  return is_driven(lane_type) || std::ranges::find(kTypes, lane_type) != kTypes.end();
}

const RoadMark* mark_at(const LaneSpec& lane, double along_m) {
  const auto next = std::ranges::upper_bound(lane.marks, along_m, {}, &RoadMark::start_m);
  return next == lane.marks.begin() ? nullptr : &*std::prev(next);
}

}  // namespace bevloc::opendrive
