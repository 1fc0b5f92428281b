#include "pipeline/map/formats/map_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <GeographicLib/LocalCartesian.hpp>

#include "common/plane.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/map_check.h"
#include "pipeline/map/map_points.h"
#include "pipeline/map/tangent_plane.h"

namespace bevloc {
namespace {

constexpr std::string_view kByRule = "by the class table";

bool is_possible(const std::vector<Eigen::Vector2d>& points) {
  return std::ranges::all_of(points, is_near_origin);
}

/// Removes impossible lanes, and the successors that name them.
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
  Polyline flat;
  for (const Eigen::Vector3d& point : line) flat.emplace_back(point.head<2>());
  Line3 rest;
  for (const size_t i : kept_points(flat, tolerance_m)) rest.push_back(line[i]);
  return rest;
}

Line3 closed(Line3 ring) {
  if (ring.size() > 2) ring.push_back(ring.front());
  return ring;
}

std::string_view shape_element(MapElement& element, Heights& heights_m) {
  Polyline& points = element.points;
  const auto keep = [&](const std::vector<size_t>& indices) {
    for (size_t i = 0; i < indices.size(); ++i) {
      points[i] = points[indices[i]];
      if (!heights_m.empty()) heights_m[i] = heights_m[indices[i]];
    }
    points.resize(indices.size());
    heights_m.resize(std::min(heights_m.size(), indices.size()));
  };
  std::vector<size_t> distinct;
  for (size_t i = 0; i < points.size(); ++i) {
    if (i == 0 || points[i] != points[i - 1]) distinct.push_back(i);
  }
  const bool ring = is_ring(element.element_class);
  if (ring && distinct.size() > 1 && points[distinct.back()] == points.front()) {
    distinct.pop_back();
  }
  keep(distinct);
  if (ring) keep(corners_of_ring(points));
  if (points.size() < (ring ? 3 : 2)) return "too few points";
  if (ring && area_of_ring_m2(points) < kLeastCrossing_m2) return "too small for a crossing";
  return "";
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
  const bool by_rule = options_.classes != nullptr && options_.classes->rule_for(kind) != nullptr;
  const std::optional<Meaning> meaning = meaning_of(kind, normally);
  std::string_view why = by_rule ? kByRule : why_not;
  if (meaning) {
    MapElement element{meaning->element_class, meaning->appearance, {}};
    Heights heights_m;
    const bool has_heights = std::ranges::all_of(
        line, [](const Eigen::Vector3d& point) { return std::isfinite(point.z()); });
    for (const Eigen::Vector3d& point : line) {
      element.points.emplace_back(point.head<2>());
      if (has_heights) heights_m.push_back(point.z());
    }
    const std::string_view fault = shape_element(element, heights_m);
    if (fault.empty()) {
      sources_.push_back(
          {std::string(kind), std::string(where), *meaning, by_rule, bevloc::length_of(element)});
      map_.elements.push_back(std::move(element));
      heights_m_.push_back(std::move(heights_m));
      return;
    }
    why = fault;
  }
  report_.note(kind, std::nullopt, why, length_of(line), where);
}

void MapBuilder::drop(std::string_view kind, std::string_view where, std::string_view why,
                      double length_m) {
  report_.note(kind, std::nullopt, why, length_m, where);
}

Eigen::Vector2d MapBuilder::middle() const {
  std::vector<Eigen::Vector2d> points;
  for (const MapElement& element : map_.elements) {
    points.insert(points.end(), element.points.begin(), element.points.end());
  }
  return points.empty() ? Eigen::Vector2d(0.0, 0.0) : median_point(points);
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
  const Eigen::Vector2d center = middle();
  if (projection != nullptr) {
    map_.origin = projection->geographic(center);
    const GeographicLib::LocalCartesian plane(map_.origin.latitude_deg, map_.origin.longitude_deg);
    move_points(map_, [&](const Eigen::Vector2d& point) {
      return point_of(plane, projection->geographic(point));
    });
    return;
  }
  remark("the file does not say where on earth it is; give --origin LATITUDE,LONGITUDE");
  if (center.norm() <= kFarFromZeroM) return;
  const Eigen::Vector2d shift = -center.array().round().matrix();
  report_.remark_shift(shift);
  move_points(map_,
              [&shift](const Eigen::Vector2d& point) { return Eigen::Vector2d(point + shift); });
}

void MapBuilder::drop_impossible() {
  size_t kept = 0;
  for (size_t i = 0; i < map_.elements.size(); ++i) {
    MapElement& element = map_.elements[i];
    const Source& source = sources_[i];
    const bool near = is_possible(element.points);
    if (near && polyline_length(element.points) <= kLongestPolylineM) {
      report_.note(source.kind, source.meaning, source.is_by_rule ? kByRule : "", source.length_m,
                   source.where);
      if (kept != i) {
        map_.elements[kept] = std::move(element);
        heights_m_[kept] = std::move(heights_m_[i]);
      }
      ++kept;
      continue;
    }
    report_.note(source.kind, std::nullopt, near ? "too long" : "too far from the middle",
                 source.length_m, source.where);
    leave_out(fmt::format("{}: {}: found a {} {}, wanted at most {:g} km", file_, source.where,
                          source.kind, near ? "that is too long" : "too far from the middle",
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
    const Eigen::Vector2d center = middle();
    if (!is_near_origin(center)) return far_from_origin(file_, center);
    report_.remark_far_origin(center);
    projection = tangent_projection(*options_.origin);
  }
  place(projection.get());
  drop_impossible();
  if (options_.classes != nullptr) {
    const Status status = check_rules(*options_.classes, report_, file_);
    if (!status) return tl::unexpected(status.error());
  }
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
