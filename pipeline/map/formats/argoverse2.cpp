#include "pipeline/map/formats/argoverse2.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "pipeline/map/formats/area_cover.h"
#include "pipeline/map/formats/json_points.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/line_neighbours.h"
#include "pipeline/map/map_check.h"

namespace bevloc {
namespace {

/// The distance without the heights, which a point may lack.
double distance_on_ground(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).head<2>().norm();
}

using nlohmann::json;

/// The origins of the coordinates of the cities, as the API of the data set states them.
struct City {
  std::string_view name;
  int utm_zone;
  GeoOrigin origin;
};
constexpr std::array kCities{
    City{"ATX", 14, {30.27464237939507, -97.7404457407424}},
    City{"DTW", 17, {42.29993066912924, -83.17555750783717}},
    City{"MIA", 17, {25.77452579915163, -80.19656914449405}},
    City{"PAO", 10, {37.416065, -122.13571963362166}},
    City{"PIT", 17, {40.44177902989321, -80.01294377242584}},
    City{"WDC", 18, {38.889377, -77.0355047439081}},
};

std::optional<City> city_of(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  for (const City& city : kCities) {
    if (name.find(fmt::format("_{}_city", city.name)) != std::string::npos) return city;
  }
  return std::nullopt;
}

/// Returns what a left_lane_mark_type means, or nothing for NONE and for unknown types. A solid
/// line with a dashed one beside it (SOLID_DASH_WHITE, DASH_SOLID_WHITE) counts as solid.
std::optional<Meaning> meaning_of_mark(std::string_view type) {
  if (type.starts_with("DOUBLE_SOLID")) {
    return Meaning{ElementClass::kLaneDivider, Appearance::kDoubleSolid};
  }
  if (type.starts_with("DASHED") || type.starts_with("DOUBLE_DASH")) {
    return Meaning{ElementClass::kLaneDivider, Appearance::kDashed};
  }
  if (type.starts_with("SOLID") || type.starts_with("DASH_SOLID")) {
    return Meaning{ElementClass::kLaneDivider, Appearance::kSolid};
  }
  return std::nullopt;
}

Polyline flat(const Line3& line) {
  Polyline points;
  for (const Eigen::Vector3d& point : line) {
    if (points.empty() || points.back() != point.head<2>()) points.emplace_back(point.head<2>());
  }
  return points;
}

/// Two bounds this close, along this share, are the same line.
constexpr double kSameMark_m = 0.4;
constexpr double kSameMarkShare = 0.8;
/// No lane is wider than twice this.
constexpr double kWidestHalf_m = 10.0;

double distance_to_bound(const Eigen::Vector2d& point, const Polyline& bound) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i + 1 < bound.size(); ++i) {
    nearest_m = std::min(nearest_m, distance_to_segment(point, bound[i], bound[i + 1]));
  }
  return nearest_m;
}

class Argoverse2Reader {
 public:
  Argoverse2Reader(const JsonText& document, const ImportOptions& options)
      : json_(document), builder_(document.file(), options) {}

  Result<ImportedMap> read(const std::filesystem::path& file) {
    for (const auto read : {&Argoverse2Reader::read_lanes, &Argoverse2Reader::read_crossings,
                            &Argoverse2Reader::read_areas}) {
      if (Status status = (this->*read)(); !status) return tl::unexpected(status.error());
    }
    std::unique_ptr<Projection> projection;
    if (const auto city = city_of(file)) {
      builder_.remark(
          fmt::format("coordinates of the city {} (from the name of the file)", city->name));
      projection = utm_projection(city->utm_zone, true, utm_point(city->origin, city->utm_zone));
    }
    return builder_.finish(file.stem().string(), std::move(projection));
  }

 private:
  /// Calls use(value, path, id) for each member of an object; stops at the first error.
  template <typename Use>
  Status for_each(const char* key, Use use) {
    const json& parts = member(json_.root(), key);
    const JsonPath path = JsonPath() / key;
    if (!parts.is_object()) {
      return fail("{}: found {}, wanted an object with one member for each part", json_.place(path),
                  parts.is_null() ? "nothing" : parts.type_name());
    }
    for (const auto& [id, part] : parts.items()) {
      if (Status status = use(part, path / id, id); !status) return status;
    }
    return {};
  }

  Status read_lanes() {
    Status status = for_each(
        "lane_segments",
        [&](const json& lane, const JsonPath& path, const std::string& id) -> Status {
          auto left =
              xyz_points(json_, member(lane, "left_lane_boundary"), path / "left_lane_boundary", 2);
          if (!left) return tl::unexpected(left.error());
          auto right = xyz_points(json_, member(lane, "right_lane_boundary"),
                                  path / "right_lane_boundary", 2);
          if (!right) return tl::unexpected(right.error());
          const std::string type = text_member(lane, "lane_type");
          add_mark(text_member(lane, "left_lane_mark_type"), "left of lane " + id, *left);
          add_mark(text_member(lane, "right_lane_mark_type"), "right of lane " + id, *right);
          if (type != "VEHICLE" && type != "BUS") return {};
          Lane driven;
          driven.left = flat(*left);
          driven.right = flat(*right);
          if (!can_be_lane(driven.left, driven.right)) {
            builder_.leave_out(
                fmt::format("{}: found bounds that have a single point or are too long, wanted 2 "
                            "points or more, and at most {:g} m",
                            json_.place(path), kLongestPolylineM));
            return {};
          }
          driven.centerline = centerline_between(driven.left, driven.right);
          const uint32_t index = builder_.add_lane(std::move(driven));
          centers_.add(index, builder_.lanes()[index].centerline);
          lane_of_[id] = index;
          return {};
        });
    if (status) link();
    return status;
  }

  void add_mark(const std::string& type, const std::string& where, const Line3& line) {
    const std::string kind = "lane mark " + (type.empty() ? "NONE" : type);
    const auto normally = meaning_of_mark(type);
    if (!builder_.meaning_of(kind, normally) || length_of(line) > kLongestPolylineM) {
      const bool is_none = type == "NONE" || type.empty();
      builder_.add(kind, where, normally, is_none ? "not painted" : "no known mark", line);
      return;
    }
    const Polyline points = flat(line);
    const auto any = [](int64_t) { return true; };
    if (marks_.share_beside(points, kSameMark_m, any) >= kSameMarkShare) {
      builder_.drop(kind, where, "the neighbouring lane has the same line", length_of(line));
      return;
    }
    marks_.add(mark_count_++, points);
    builder_.add(kind, where, normally, "", line);
  }

  void link() {
    for (const auto& [id, index] : lane_of_) {
      const json& successors = member(json_.root()["lane_segments"][id], "successors");
      if (!successors.is_array()) continue;
      for (const json& successor : successors) {
        const auto next = lane_of_.find(id_text(successor));
        if (next != lane_of_.end()) builder_.lanes()[index].successors.push_back(next->second);
      }
    }
  }

  Status read_crossings() {
    return for_each(
        "pedestrian_crossings",
        [&](const json& crossing, const JsonPath& path, const std::string& id) -> Status {
          auto ring = xyz_points(json_, member(crossing, "edge1"), path / "edge1", 2);
          if (!ring) return tl::unexpected(ring.error());
          auto back = xyz_points(json_, member(crossing, "edge2"), path / "edge2", 2);
          if (!back) return tl::unexpected(back.error());
          const bool same_way = distance_on_ground(ring->front(), back->front()) +
                                    distance_on_ground(ring->back(), back->back()) <
                                distance_on_ground(ring->front(), back->back()) +
                                    distance_on_ground(ring->back(), back->front());
          if (same_way) std::ranges::reverse(*back);
          ring->insert(ring->end(), back->begin(), back->end());
          builder_.add("pedestrian crossing", "crossing " + id,
                       Meaning{ElementClass::kPedestrianCrossing, Appearance::kUnknown}, "",
                       closed(std::move(*ring)));
          return {};
        });
  }

  Status read_areas() {
    std::vector<Area> areas;
    std::vector<std::string> ids;
    const Status status = for_each(
        "drivable_areas",
        [&](const json& area, const JsonPath& path, const std::string& id) -> Status {
          auto ring = xyz_points(json_, member(area, "area_boundary"), path / "area_boundary", 3);
          if (!ring) return tl::unexpected(ring.error());
          if (!take_outline(
                  *ring, [&] { return json_.place(path); }, builder_))
            return {};
          areas.push_back({std::move(*ring)});
          ids.push_back(id);
          return {};
        });
    const AreaCover cover(std::move(areas));
    for (size_t i = 0; i < ids.size(); ++i) {
      for (Line3& line : cover.outline_of(i)) add_outline("area " + ids[i], std::move(line));
    }
    return status;
  }

  /// Whether an edge lies across a lane: within half the width of the lane from its centre line,
  /// and at more than 45 degrees to it. Edges that taper with a lane are near its centre line, too.
  bool cuts_lane(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d middle = 0.5 * (from + to);
    return centers_.has_near(middle, kWidestHalf_m, [&](const LineNeighbours::Segment& center) {
      const Eigen::Vector2d edge = to - from;
      const Eigen::Vector2d along = center.to - center.from;
      if (std::abs(edge.dot(along)) >= std::abs(cross(edge, along))) return false;
      const Polyline& bound = builder_.lanes()[static_cast<size_t>(center.id)].left;
      const double half_m =
          std::max(distance_to_bound(center.from, bound), distance_to_bound(center.to, bound));
      return distance_to_segment(middle, center.from, center.to) <= half_m;
    });
  }

  /// Cuts an outline where it crosses a lane, which happens at the ends of the map.
  void add_outline(const std::string& where, Line3 line) {
    Line3 kept;
    const auto flush = [&] {
      builder_.add("edge of the drivable area", where,
                   Meaning{ElementClass::kRoadBoundary, Appearance::kUnknown}, "",
                   simplified(kept, 0.02));
      kept.clear();
    };
    for (size_t i = 0; i + 1 < line.size(); ++i) {
      const Eigen::Vector2d from = line[i].head<2>();
      const Eigen::Vector2d to = line[i + 1].head<2>();
      if (cuts_lane(from, to)) {
        builder_.drop("edge of the drivable area", where, "it cuts a lane at the end of the map",
                      (to - from).norm());
        if (kept.size() > 1) flush();
        kept.clear();
        continue;
      }
      if (kept.empty()) kept.push_back(line[i]);
      kept.push_back(line[i + 1]);
    }
    if (kept.size() > 1) flush();
  }

  const JsonText& json_;
  MapBuilder builder_;
  std::unordered_map<std::string, uint32_t> lane_of_;
  LineNeighbours marks_;    ///< marks taken so far
  LineNeighbours centers_;  ///< centre lines of lanes for vehicles
  int64_t mark_count_ = 0;
};

}  // namespace

Result<ImportedMap> parse_argoverse2(std::string_view text, const std::filesystem::path& file,
                                     const ImportOptions& options) {
  const auto document = JsonText::parse(text, file.string());
  if (!document) return tl::unexpected(document.error());
  return Argoverse2Reader(*document, options).read(file);
}

}  // namespace bevloc
