#include "pipeline/map/formats/opendrive/road.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace bevloc::opendrive {
namespace {

/// Integrates along a spiral and along the length of a cubic in pieces this long.
constexpr double kStep_m = 2.0;
constexpr double kMostSteps = 10'000.0;
/// Gaps in a road that are not larger than this are rounding errors.
constexpr double kGap_m = 0.1;
/// Sections whose starts are closer than this start together.
constexpr double kSameStart_m = 1e-6;
/// These are more copies of an object, and more corners of each, than any road has.
constexpr double kMostCopies = 1000.0;
constexpr size_t kMostCorners = 100;

/// Gauss-Legendre quadrature with three points of f from `begin` to `end`, added to `sum`.
template <typename Value, typename Function>
Value integral(double begin, double end, Value sum, Function f) {
  const double steps = std::clamp(std::ceil(std::abs(end - begin) / kStep_m), 1.0, kMostSteps);
  const double half = 0.5 * (end - begin) / steps;
  const double reach = half * std::sqrt(0.6);
  for (double i = 0.0; i < steps; i += 1.0) {
    const double middle = begin + (2.0 * i + 1.0) * half;
    sum += half / 9.0 * (5.0 * f(middle - reach) + 8.0 * f(middle) + 5.0 * f(middle + reach));
  }
  return sum;
}

/// The last knot at or before a place of a piece, or the start of the piece if there is none.
Geometry::Knot knot_before(const Geometry& geometry, double along_m) {
  const auto next = std::ranges::upper_bound(geometry.knots, along_m, {}, &Geometry::Knot::along_m);
  return next == geometry.knots.begin() ? Geometry::Knot() : *std::prev(next);
}

LinePose spiral_pose(const Geometry& geometry, double along_m) {
  const double c0 = geometry.start_curvature;
  const double rate =
      geometry.length_m > 0.0 ? (geometry.end_curvature - c0) / geometry.length_m : 0.0;
  const auto heading = [&](double at) { return at * (c0 + 0.5 * rate * at); };
  const Geometry::Knot knot = knot_before(geometry, along_m);
  const Eigen::Vector2d position = integral(knot.along_m, along_m, knot.position, [&](double at) {
    return Eigen::Vector2d(std::cos(heading(at)), std::sin(heading(at)));
  });
  return {position, heading(along_m)};
}

double slope_of_poly3(const Geometry& geometry, double u) {
  return geometry.v.b + u * (2.0 * geometry.v.c + u * 3.0 * geometry.v.d);
}

/// The length of the curve of a poly3 from the start of the piece to u, which follows the knot.
double length_of_poly3(const Geometry& geometry, const Geometry::Knot& knot, double u) {
  return integral(knot.position.x(), u, knot.along_m,
                  [&](double at) { return std::hypot(1.0, slope_of_poly3(geometry, at)); });
}

LinePose poly3_pose(const Geometry& geometry, double along_m) {
  constexpr double kExact_m = 1e-9;
  const Geometry::Knot knot = knot_before(geometry, along_m);
  // Newton's method finds the u up to which the curve has the length along_m.
  double u = knot.position.x() + along_m - knot.along_m;
  double step_m = 1.0;
  for (int i = 0; i < 8 && std::abs(step_m) > kExact_m; ++i) {
    step_m = (length_of_poly3(geometry, knot, u) - along_m) /
             std::hypot(1.0, slope_of_poly3(geometry, u));
    u -= step_m;
  }
  return {{u, geometry.v.at(u)}, std::atan(slope_of_poly3(geometry, u))};
}

/// The pose in the frame of the start of the piece.
LinePose local_pose(const Geometry& geometry, double along_m) {
  const double c0 = geometry.start_curvature;
  switch (geometry.kind) {
    case Geometry::Kind::kLine:
      return {{along_m, 0.0}, 0.0};
    case Geometry::Kind::kArc: {
      const double angle = c0 * along_m;
      if (std::abs(c0) < 1e-12) return {{along_m, 0.0}, 0.0};
      return {{std::sin(angle) / c0, (1.0 - std::cos(angle)) / c0}, angle};
    }
    case Geometry::Kind::kSpiral:
      return spiral_pose(geometry, along_m);
    case Geometry::Kind::kPoly3:
      return poly3_pose(geometry, along_m);
    case Geometry::Kind::kParamPoly3: {
      const double scale =
          geometry.is_normalized && geometry.length_m > 0.0 ? 1.0 / geometry.length_m : 1.0;
      const double p = along_m * scale;
      const auto slope = [p](const Cubic& cubic) {
        return cubic.b + p * (2.0 * cubic.c + p * 3.0 * cubic.d);
      };
      return {{geometry.u.at(p), geometry.v.at(p)},
              std::atan2(slope(geometry.v), slope(geometry.u))};
    }
  }
  return {};
}

bool has_paint(const LaneSpec& lane) {
  return std::ranges::any_of(
      lane.marks, [](const RoadMark& mark) { return !mark.type.empty() && mark.type != "none"; });
}

/// The lane with its places counted from another start of its section.
LaneSpec moved(LaneSpec lane, double shift_m) {
  for (Cubics* cubics : {&lane.widths, &lane.borders}) {
    for (Cubic& cubic : *cubics) cubic.start_m += shift_m;
  }
  for (RoadMark& mark : lane.marks) mark.start_m += shift_m;
  return lane;
}

/// Gives a single-sided section the lanes and marks of the section before that it does not state
/// itself.
void take_over(const LaneSection& before, LaneSection& section) {
  const double shift_m = before.start_m - section.start_m;
  const bool has_right = section.lanes.front().id < 0;
  const bool has_left = section.lanes.back().id > 0;
  for (const LaneSpec& lane : before.lanes) {
    if (lane.id != 0) {
      if (!(lane.id < 0 ? has_right : has_left)) section.lanes.push_back(moved(lane, shift_m));
      continue;
    }
    LaneSpec& centre = *std::ranges::find(section.lanes, 0, &LaneSpec::id);
    const bool says_marks = -shift_m < kSameStart_m ? has_paint(centre) : !centre.marks.empty();
    if (!says_marks) centre.marks = moved(lane, shift_m).marks;
  }
  std::ranges::stable_sort(section.lanes, {}, &LaneSpec::id);
}

}  // namespace

double value_at(const Cubics& cubics, double s_m, bool from_before) {
  const auto next = from_before ? std::ranges::lower_bound(cubics, s_m, {}, &Cubic::start_m)
                                : std::ranges::upper_bound(cubics, s_m, {}, &Cubic::start_m);
  return next == cubics.begin() ? 0.0 : std::prev(next)->at(s_m);
}

double RoadMark::left_of_border_m(double along_m, bool from_before) const {
  return offset_m + value_at(sways, along_m - start_m, from_before);
}

void place_knots(Geometry& geometry) {
  constexpr double kSpacing_m = 100.0;
  geometry.knots.clear();
  if (geometry.kind == Geometry::Kind::kSpiral) {
    for (double at = kSpacing_m; at < geometry.length_m; at += kSpacing_m) {
      geometry.knots.push_back({at, spiral_pose(geometry, at).position});
    }
  }
  if (geometry.kind == Geometry::Kind::kPoly3) {
    Geometry::Knot knot;
    for (double u = kSpacing_m; u < geometry.length_m; u += kSpacing_m) {
      const double along_m = length_of_poly3(geometry, knot, u);
      if (!(along_m < geometry.length_m)) break;
      knot = {along_m, {u, geometry.v.at(u)}};
      geometry.knots.push_back(knot);
    }
  }
}

LinePose pose_along(const Geometry& geometry, double along_m) {
  LinePose local = local_pose(geometry, along_m);
  // Cubics that no road has may diverge.
  if (!local.position.allFinite() || !std::isfinite(local.heading_rad)) local = {};
  const double c = std::cos(geometry.heading_rad);
  const double s = std::sin(geometry.heading_rad);
  return {geometry.origin + Eigen::Vector2d(c * local.position.x() - s * local.position.y(),
                                            s * local.position.x() + c * local.position.y()),
          geometry.heading_rad + local.heading_rad};
}

LinePose Road::pose_at(double s_m, bool from_before) const {
  const auto next = from_before ? std::ranges::lower_bound(geometries, s_m, {}, &Geometry::start_m)
                                : std::ranges::upper_bound(geometries, s_m, {}, &Geometry::start_m);
  const Geometry& geometry = next == geometries.begin() ? *next : *std::prev(next);
  return pose_along(geometry, std::clamp(s_m - geometry.start_m, 0.0, geometry.length_m));
}

bool Road::has_line_at(double s_m) const {
  return std::ranges::any_of(stretches, [s_m](const Stretch& stretch) {
    return s_m >= stretch.start_m - kGap_m && s_m <= stretch.end_m + kGap_m;
  });
}

std::vector<Stretch> stretches_of(const Road& road) {
  std::vector<Stretch> stretches;
  if (road.geometries.empty()) return stretches;
  const double first_m = road.geometries.front().start_m;
  double start_m = first_m > kGap_m ? first_m : 0.0;
  for (size_t i = 0; i + 1 < road.geometries.size(); ++i) {
    const Geometry& piece = road.geometries[i];
    const Geometry& next = road.geometries[i + 1];
    const double along_m = std::min(next.start_m - piece.start_m, piece.length_m);
    const double jump_m = (next.origin - pose_along(piece, along_m).position).norm();
    if (jump_m <= kGap_m) continue;
    stretches.push_back({start_m, std::min(next.start_m, piece.start_m + along_m), jump_m});
    start_m = next.start_m;
  }
  const double end_m = road.geometries.back().start_m + road.geometries.back().length_m;
  stretches.push_back({start_m, end_m + kGap_m < road.length_m ? end_m : road.length_m});
  return stretches;
}

void complete_sides(std::vector<LaneSection>& sections) {
  if (std::ranges::none_of(sections, &LaneSection::is_single_side)) return;
  std::vector<LaneSection> whole;
  for (LaneSection& section : sections) {
    const bool completes = section.is_single_side && !whole.empty();
    if (completes) take_over(whole.back(), section);
    if (completes && section.start_m - whole.back().start_m < kSameStart_m) {
      section.start_m = whole.back().start_m;
      whole.back() = std::move(section);
    } else {
      whole.push_back(std::move(section));
    }
  }
  sections = std::move(whole);
}

void snap_lane_offsets(Road& road) {
  constexpr double kSamePlace_m = 0.005;
  std::vector<double> ends;
  for (const LaneSection& section : road.sections) ends.push_back(section.start_m);
  if (!road.sections.empty()) ends.push_back(road.sections.back().end_m);
  std::ranges::sort(ends);
  for (Cubic& offset : road.lane_offsets) {
    const auto end = std::ranges::lower_bound(ends, offset.start_m - kSamePlace_m);
    if (end != ends.end() && *end <= offset.start_m + kSamePlace_m) offset.start_m = *end;
  }
}

std::vector<std::string> faults_of(const Road& road, std::string_view file) {
  std::vector<std::string> faults;
  const auto add = [&](int line, const std::string& found_and_wanted) {
    faults.push_back(
        fmt::format("{}:{}: road {}: found {}", file, line, road.id, found_and_wanted));
  };
  const double first_m = road.geometries.front().start_m;
  const double end_m = road.geometries.back().start_m + road.geometries.back().length_m;
  if (first_m > kGap_m) {
    add(road.line, fmt::format("the first <geometry> at s={:g}, wanted s=0", first_m));
  }
  if (std::abs(end_m - road.length_m) > kGap_m) {
    add(road.line, fmt::format("a length of {:g} m, wanted {:g} m, where its <planView> ends",
                               road.length_m, end_m));
  }
  for (size_t i = 0; i + 1 < road.stretches.size(); ++i) {
    add(road.line, fmt::format("a gap of {:g} m after s={:g}, wanted a <planView> without gaps",
                               road.stretches[i].jump_m, road.stretches[i].end_m));
  }
  const LaneSection& first = road.sections.front();
  if (first.start_m > kGap_m) {
    add(first.line, fmt::format("the first <laneSection> at s={:g}, wanted s=0", first.start_m));
  }
  for (const LaneSection& section : road.sections) {
    if (section.start_m <= road.length_m + kGap_m) continue;
    add(section.line, fmt::format("a <laneSection> at s={:g}, wanted at most the length of {:g} m",
                                  section.start_m, road.length_m));
  }
  return faults;
}

bool is_crosswalk(const RoadObject& object) {
  if (object.type == "crosswalk") return true;
  const bool has_type = !object.type.empty() && object.type != "none" && object.type != "-1";
  if (has_type) return false;
  std::string name = object.name;
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.find("crosswalk") != std::string::npos;
}

std::vector<RoadObject> copies_of(const RoadObject& object) {
  if (object.repeats.empty()) return {object};
  RoadObject single = object;
  single.repeats.clear();
  size_t corners = 0;
  for (const Outline& outline : object.outlines) {
    corners += outline.corners.size();
    if (!std::ranges::all_of(outline.corners, &Corner::is_local) || corners > kMostCorners)
      return {};
  }
  std::vector<RoadObject> copies;
  for (const Repeat& repeat : object.repeats) {
    const double last = std::floor(repeat.length_m / repeat.distance_m + 1e-6);
    const bool is_possible =
        repeat.distance_m > 0.0 && static_cast<double>(copies.size()) + last < kMostCopies;
    if (!is_possible) return {};
    for (double i = 0.0; i <= last; i += 1.0) {
      const double along_m = i * repeat.distance_m;
      const double share = repeat.length_m > 0.0 ? along_m / repeat.length_m : 0.0;
      const auto between = [share](const std::array<double, 2>& ends) {
        return std::lerp(ends[0], ends[1], share);
      };
      RoadObject& copy = copies.emplace_back(single);
      copy.s_m = repeat.start_m + along_m;
      copy.t_m = between(repeat.t_m);
      copy.z_m = between(repeat.z_m);
      const double length_m = between(repeat.object_length_m);
      const double width_m = between(repeat.object_width_m);
      // 0 stands for the size of the object itself.
      if (length_m > 0.0) copy.length_m = length_m;
      if (width_m > 0.0) copy.width_m = width_m;
    }
  }
  return copies;
}

}  // namespace bevloc::opendrive
