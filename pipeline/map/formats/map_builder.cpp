#include "pipeline/map/formats/map_builder.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <GeographicLib/LocalCartesian.hpp>

#include "common/plane.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/map_check.h"
#include "pipeline/map/tangent_plane.h"

namespace bevloc {
namespace {

/// Coordinates of a file that are further from zero are shifted.
constexpr double kFarFromZero_m = 20'000.0;

/// The median of all points; (0, 0) if there are none.
Eigen::Vector2d middle_of_elements(const HdMap& map) {
  std::vector<Eigen::Vector2d> points;
  for (const MapElement& element : map.elements) {
    points.insert(points.end(), element.points.begin(), element.points.end());
  }
  return points.empty() ? Eigen::Vector2d(0.0, 0.0) : median_point(points);
}

void move_points(HdMap& map, const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& moved) {
  for (MapElement& element : map.elements) {
    for (Eigen::Vector2d& point : element.points) point = moved(point);
  }
  for (Lane& lane : map.lanes) {
    for (auto* line : {&lane.left, &lane.right, &lane.centerline}) {
      for (Eigen::Vector2d& point : *line) point = moved(point);
    }
  }
}

bool is_possible(const std::vector<Eigen::Vector2d>& points) {
  return std::ranges::all_of(points, [](const Eigen::Vector2d& point) {
    return point.cwiseAbs().maxCoeff() <= kFarthestFromOriginM;
  });
}

/// Removes lanes that cannot be, and the successors that name them.
void drop_impossible_lanes(std::vector<Lane>& lanes) {
  constexpr uint32_t kGone = ~0U;
  std::vector<uint32_t> new_index(lanes.size(), kGone);
  uint32_t kept = 0;
  for (size_t i = 0; i < lanes.size(); ++i) {
    const Lane& lane = lanes[i];
    const bool good = is_possible(lane.left) && is_possible(lane.right) &&
                      is_possible(lane.centerline) && can_be_driven(lane.centerline);
    if (good) new_index[i] = kept++;
  }
  for (size_t i = 0; i < lanes.size(); ++i) {
    for (uint32_t& next : lanes[i].successors) next = new_index[next];
    std::erase(lanes[i].successors, kGone);
    if (new_index[i] != kGone && new_index[i] != i) lanes[new_index[i]] = std::move(lanes[i]);
  }
  lanes.resize(kept);
}

}  // namespace

bool can_be_driven(const Polyline& centerline) {
  const double length_m = polyline_length(centerline);
  return length_m >= kShortestLaneM && length_m <= kLongestPolylineM;
}

bool can_be_lane(const std::vector<Eigen::Vector2d>& left,
                 const std::vector<Eigen::Vector2d>& right) {
  return left.size() > 1 && right.size() > 1 && polyline_length(left) <= kLongestPolylineM &&
         polyline_length(right) <= kLongestPolylineM;
}

double length_of(const Line3& line) {
  double length_m = 0.0;
  for (size_t i = 1; i < line.size(); ++i) {
    length_m += (line[i].head<2>() - line[i - 1].head<2>()).norm();
  }
  return length_m;
}

Line3 simplified(const Line3& line, double tolerance_m) {
  if (line.size() < 3) return line;
  std::vector<bool> kept(line.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<size_t, size_t>> open{{0, line.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double worst_m = tolerance_m;
    size_t split = 0;
    for (size_t i = first + 1; i < last; ++i) {
      const double distance_m =
          distance_to_segment(line[i].head<2>(), line[first].head<2>(), line[last].head<2>());
      if (distance_m <= worst_m) continue;
      worst_m = distance_m;
      split = i;
    }
    if (split == 0) continue;
    kept[split] = true;
    open.emplace_back(first, split);
    open.emplace_back(split, last);
  }
  Line3 rest;
  for (size_t i = 0; i < line.size(); ++i) {
    if (kept[i]) rest.push_back(line[i]);
  }
  return rest;
}

MapBuilder::MapBuilder(std::string file, const ImportOptions& options)
    : file_(std::move(file)), options_(options) {}

std::optional<Meaning> MapBuilder::meaning_of(std::string_view kind,
                                              const std::optional<Meaning>& normally) const {
  const auto* rule = options_.classes == nullptr ? nullptr : options_.classes->rule_for(kind);
  return rule == nullptr ? normally : rule->becomes;
}

void MapBuilder::add(std::string_view kind, std::string_view where,
                     const std::optional<Meaning>& normally, std::string_view why_not, Line3 line) {
  const auto is_same = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.head<2>() == b.head<2>();
  };
  line.erase(std::unique(line.begin(), line.end(), is_same), line.end());
  const bool by_rule = options_.classes != nullptr && options_.classes->rule_for(kind) != nullptr;
  std::optional<Meaning> meaning = meaning_of(kind, normally);
  std::string_view why = by_rule ? "by the class table" : meaning ? "" : why_not;
  const bool is_ring = meaning && meaning->element_class == ElementClass::kPedestrianCrossing;
  if (is_ring && line.size() > 1 && is_same(line.front(), line.back())) line.pop_back();
  double length_m = length_of(line);
  if (is_ring && line.size() > 2) length_m += (line.front() - line.back()).head<2>().norm();
  if (meaning && line.size() < (is_ring ? 3 : 2)) {
    meaning.reset();
    why = "too few points";
  }
  report_.note(kind, meaning, why, length_m, where);
  if (!meaning) return;
  MapElement element{meaning->element_class, meaning->appearance, {}};
  Heights heights_m;
  const bool has_heights = std::ranges::all_of(
      line, [](const Eigen::Vector3d& point) { return std::isfinite(point.z()); });
  for (const Eigen::Vector3d& point : line) {
    element.points.emplace_back(point.head<2>());
    if (has_heights) heights_m.push_back(point.z());
  }
  map_.elements.push_back(std::move(element));
  heights_m_.push_back(std::move(heights_m));
  kinds_.emplace_back(kind);
  wheres_.emplace_back(where);
}

void MapBuilder::drop(std::string_view kind, std::string_view where, std::string_view why,
                      double length_m) {
  report_.note(kind, std::nullopt, why, length_m, where);
}

uint32_t MapBuilder::add_lane(Lane lane) {
  map_.lanes.push_back(std::move(lane));
  return static_cast<uint32_t>(map_.lanes.size() - 1);
}

void MapBuilder::place(const Projection* projection) {
  if (plane_at_) {
    map_.origin = *plane_at_;
    return;
  }
  const Eigen::Vector2d middle = middle_of_elements(map_);
  if (projection != nullptr) {
    map_.origin = projection->geographic(middle);
    const GeographicLib::LocalCartesian plane(map_.origin.latitude_deg, map_.origin.longitude_deg);
    move_points(map_, [&](const Eigen::Vector2d& point) {
      return point_of(plane, projection->geographic(point));
    });
    return;
  }
  remark("the file does not say where on earth it is: --origin LATITUDE,LONGITUDE does");
  if (middle.norm() <= kFarFromZero_m) return;
  const Eigen::Vector2d shift = -middle.array().round().matrix();
  report_.remark_shift(shift);
  move_points(map_,
              [&shift](const Eigen::Vector2d& point) { return Eigen::Vector2d(point + shift); });
}

void MapBuilder::drop_impossible() {
  size_t kept = 0;
  for (size_t i = 0; i < map_.elements.size(); ++i) {
    MapElement& element = map_.elements[i];
    const bool near = is_possible(element.points);
    if (near && polyline_length(element.points) <= kLongestPolylineM) {
      if (kept != i) {
        map_.elements[kept] = std::move(element);
        heights_m_[kept] = std::move(heights_m_[i]);
      }
      ++kept;
      continue;
    }
    leave_out(fmt::format("{}: {}: found a {} {}, wanted at most {:g} km", file_, wheres_[i],
                          kinds_[i], near ? "that is too long" : "too far from the middle",
                          (near ? kLongestPolylineM : kFarthestFromOriginM) / 1000.0));
  }
  map_.elements.resize(kept);
  heights_m_.resize(kept);
  const size_t lanes = map_.lanes.size();
  drop_impossible_lanes(map_.lanes);
  if (const size_t gone = lanes - map_.lanes.size(); gone > 0) {
    leave_out(fmt::format(
        "{}: found {} lanes that are too short, too long or too far from the middle, "
        "wanted {:g} m to {:g} km, and at most {:g} km",
        file_, gone, kShortestLaneM, kLongestPolylineM / 1000.0, kFarthestFromOriginM / 1000.0));
  }
}

Result<ImportedMap> MapBuilder::finish(std::string name, std::unique_ptr<Projection> projection) {
  if (options_.origin) {
    const Eigen::Vector2d middle = middle_of_elements(map_);
    if (middle.cwiseAbs().maxCoeff() > kFarthestFromOriginM) return far_from_origin(file_, middle);
    projection = tangent_projection(*options_.origin);
  }
  if (options_.classes != nullptr) {
    const Status status = check_rules(*options_.classes, report_, file_);
    if (!status) return tl::unexpected(status.error());
  }
  place(projection.get());
  drop_impossible();
  if (map_.elements.empty()) {
    const std::string first = map_.left_out.empty() ? "" : "; " + map_.left_out.front();
    return fail(
        "{}: found {} lanes and no line of a divider, crossing or boundary, wanted lines to "
        "match{}",
        file_, map_.lanes.size(), first);
  }
  map_.name = std::move(name);
  return ImportedMap{std::move(map_), std::move(report_), std::move(heights_m_)};
}

}  // namespace bevloc
