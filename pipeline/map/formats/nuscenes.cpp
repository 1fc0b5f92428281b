#include "pipeline/map/formats/nuscenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "common/json_dump.h"
#include "pipeline/map/formats/area_cover.h"
#include "pipeline/map/formats/json_points.h"
#include "pipeline/map/lanelet_geometry.h"

namespace bevloc {
namespace {

using nlohmann::json;

/// The map expansion states no width of a lane's curve.
constexpr double kLaneWidth_m = 3.5;
constexpr double kCurveStep_m = 1.0;
/// Longer pieces of a curve are mistakes.
constexpr double kLongestCurve_m = 1'000.0;

/// The lower left corners of the maps, as the development kit states them.
struct Place {
  std::string_view name;
  GeoOrigin origin;
};
constexpr std::array kPlaces{
    Place{"boston-seaport", {42.336849169438615, -71.05785369873047}},
    Place{"singapore-onenorth", {1.2882100868743724, 103.78475189208984}},
    Place{"singapore-hollandvillage", {1.2993652317780957, 103.78217697143555}},
    Place{"singapore-queenstown", {1.2782562240223188, 103.76741409301758}},
};

std::optional<Meaning> meaning_of_segment(std::string_view type) {
  const auto has = [type](std::string_view part) {
    return type.find(part) != std::string_view::npos;
  };
  if (type.empty() || type == "NIL") return std::nullopt;
  Appearance look = Appearance::kUnknown;
  if (has("DASHED")) {
    look = Appearance::kDashed;
  } else if (has("DOUBLE_SOLID")) {
    look = Appearance::kDoubleSolid;
  } else if (has("SOLID") || has("ZIGZAG")) {
    look = Appearance::kSolid;
  }
  return Meaning{ElementClass::kLaneDivider, look};
}

class NuscenesReader {
 public:
  NuscenesReader(const JsonText& document, const ImportOptions& options)
      : json_(document), builder_(document.file(), options) {}

  Result<ImportedMap> read(const std::filesystem::path& file) {
    for (const auto read : {&NuscenesReader::read_nodes, &NuscenesReader::read_dividers,
                            &NuscenesReader::read_crossings, &NuscenesReader::read_areas,
                            &NuscenesReader::read_curves}) {
      if (Status status = (this->*read)(); !status) return tl::unexpected(status.error());
    }
    std::unique_ptr<Projection> projection;
    const std::string name = file.stem().string();
    for (const Place& place : kPlaces) {
      if (name.find(place.name) == std::string::npos) continue;
      builder_.remark(fmt::format("the map {} (from the name of the file)", place.name));
      projection = tangent_projection(place.origin);
    }
    return builder_.finish(name, std::move(projection));
  }

 private:
  using Tokens = std::unordered_map<std::string, size_t>;

  /// Calls use(record, path) for each record of a table, which may be missing.
  template <typename Use>
  Status for_each_record(const char* table, Use use) {
    const json& records = member(json_.root(), table);
    const JsonPath path = JsonPath() / table;
    if (records.is_null()) return {};
    if (!records.is_array()) {
      return fail("{}: found {}, wanted a list", json_.place(path), records.type_name());
    }
    for (size_t i = 0; i < records.size(); ++i) {
      if (Status status = use(records[i], path / i); !status) return status;
    }
    return {};
  }

  Status index(const char* table, Tokens& tokens) {
    size_t count = 0;
    return for_each_record(table, [&](const json& record, const JsonPath& path) -> Status {
      const std::string token = text_member(record, "token");
      if (token.empty()) return fail("{}: found no token, wanted one", json_.place(path));
      tokens[token] = count++;
      return {};
    });
  }

  Status read_nodes() {
    if (Status status = index("line", lines_); !status) return status;
    if (Status status = index("polygon", polygons_); !status) return status;
    return for_each_record("node", [&](const json& node, const JsonPath& path) -> Status {
      json point = json::array({node});
      const auto points = xyz_points(json_, point, path, 1);
      if (!points) return tl::unexpected(points.error());
      Eigen::Vector3d place = points->front();
      place.z() = std::numeric_limits<double>::quiet_NaN();
      nodes_[text_member(node, "token")] = place;
      return {};
    });
  }

  Result<Line3> nodes_of(const json& tokens, const JsonPath& path) const {
    Line3 line;
    if (!tokens.is_array()) {
      return fail("{}: found no list of nodes, wanted one", json_.place(path));
    }
    for (size_t i = 0; i < tokens.size(); ++i) {
      const auto node = nodes_.find(id_text(tokens[i]));
      if (node == nodes_.end()) {
        return fail("{}: found a reference to node {:.60}, which is missing, wanted it in the file",
                    json_.place(path / i), dump_json(tokens[i]));
      }
      line.push_back(node->second);
    }
    return line;
  }

  /// The record of a table that a record refers to.
  Result<size_t> referred(const json& record, const char* key, const Tokens& tokens,
                          const JsonPath& path) const {
    const auto found = tokens.find(text_member(record, key));
    if (found != tokens.end()) return found->second;
    return fail("{}: found a {} that refers to a missing record, wanted the record in the file",
                json_.place(path), key);
  }

  Status read_dividers() {
    for (const char* table : {"lane_divider", "road_divider"}) {
      Status status =
          for_each_record(table, [&](const json& record, const JsonPath& path) -> Status {
            const auto index = referred(record, "line_token", lines_, path);
            if (!index) return tl::unexpected(index.error());
            const JsonPath at = JsonPath("/line") / *index / "node_tokens";
            const json& tokens = member(json_.root()["line"][*index], "node_tokens");
            const auto line = nodes_of(tokens, at);
            if (!line) return tl::unexpected(line.error());
            add_divider(table, record, tokens, *line);
            return {};
          });
      if (!status) return status;
    }
    return {};
  }

  /// Cuts a divider where the type of its segments changes. A segment's type belongs to the part of
  /// the line that begins at its node. A road divider without types is taken as it is.
  void add_divider(const std::string& table, const json& record, const json& tokens,
                   const Line3& line) {
    const std::string where = table + " " + text_member(record, "token");
    std::unordered_map<std::string, std::string> type_from;
    for (const json& segment : member(record, table + "_segments")) {
      type_from[text_member(segment, "node_token")] = text_member(segment, "segment_type");
    }
    std::string type;
    Line3 part;
    const auto flush = [&] {
      if (part.size() < 2) return;
      const bool is_road = type.empty() && table == "road_divider";
      const std::string kind = table + (type.empty() ? "" : " " + type);
      auto meaning = meaning_of_segment(type);
      if (is_road || (type.empty() && type_from.empty())) {
        meaning = Meaning{ElementClass::kLaneDivider, Appearance::kUnknown};
      }
      builder_.add(kind, where, meaning, "not painted", part);
    };
    for (size_t i = 0; i < line.size(); ++i) {
      part.push_back(line[i]);
      const auto next = type_from.find(id_text(tokens[i]));
      if (next == type_from.end() || next->second == type) continue;
      flush();
      type = next->second;
      part = {line[i]};
    }
    flush();
  }

  Result<Area> area_of(const std::string& token, const JsonPath& path) const {
    const auto found = polygons_.find(token);
    if (found == polygons_.end()) {
      return fail(
          "{}: found a reference to polygon \"{}\", which is missing, wanted it in the file",
          json_.place(path), token);
    }
    const JsonPath at = JsonPath("/polygon") / found->second;
    const json& polygon = json_.root()["polygon"][found->second];
    auto outer = nodes_of(member(polygon, "exterior_node_tokens"), at / "exterior_node_tokens");
    if (!outer) return tl::unexpected(outer.error());
    Area area{std::move(*outer)};
    const json& holes = member(polygon, "holes");
    for (size_t i = 0; holes.is_array() && i < holes.size(); ++i) {
      auto hole = nodes_of(member(holes[i], "node_tokens"), at / "holes" / i / "node_tokens");
      if (!hole) return tl::unexpected(hole.error());
      area.holes.push_back(std::move(*hole));
    }
    return area;
  }

  Status read_crossings() {
    return for_each_record("ped_crossing", [&](const json& record, const JsonPath& path) -> Status {
      auto area = area_of(text_member(record, "polygon_token"), path);
      if (!area) return tl::unexpected(area.error());
      const std::string where = "ped_crossing " + text_member(record, "token");
      builder_.add("ped_crossing", where,
                   Meaning{ElementClass::kPedestrianCrossing, Appearance::kUnknown}, "",
                   closed(std::move(area->outer)));
      for (const Line3& hole : area->holes) {
        builder_.drop("ped_crossing", where, "a hole in a crossing", length_of(closed(hole)));
      }
      return {};
    });
  }

  Status read_areas() {
    std::vector<Area> areas;
    std::vector<std::string> names;
    const auto read = [&](const json& record, const JsonPath& path) -> Status {
      const json& tokens = member(record, "polygon_tokens");
      for (size_t i = 0; tokens.is_array() && i < tokens.size(); ++i) {
        auto area = area_of(id_text(tokens[i]), path / "polygon_tokens" / i);
        if (!area) return tl::unexpected(area.error());
        const auto place = [&] { return json_.place(path / "polygon_tokens" / i); };
        if (!take_outline(area->outer, place, builder_)) continue;
        areas.push_back(std::move(*area));
        names.push_back("drivable_area " + text_member(record, "token"));
      }
      return {};
    };
    if (Status status = for_each_record("drivable_area", read); !status) return status;
    const AreaCover cover(std::move(areas));
    for (size_t i = 0; i < names.size(); ++i) {
      for (const Line3& line : cover.outline_of(i)) {
        builder_.add("edge of drivable_area", names[i],
                     Meaning{ElementClass::kRoadBoundary, Appearance::kUnknown}, "",
                     simplified(line, 0.02));
      }
    }
    return {};
  }

  /// The lanes' curves: each consists of arcs (left, right) and straights.
  Status read_curves() {
    const json& curves = member(json_.root(), "arcline_path_3");
    std::unordered_map<std::string, uint32_t> lane_of;
    if (!curves.is_object()) return {};
    for (const auto& [token, pieces] : curves.items()) {
      Polyline center;
      for (size_t i = 0; pieces.is_array() && i < pieces.size(); ++i) {
        Status status = append_piece(pieces[i], JsonPath("/arcline_path_3") / token / i, center);
        if (!status) return status;
      }
      if (center.size() < 2) continue;
      lane_of[token] = builder_.add_lane(lane_around(center));
    }
    const json& connectivity = member(json_.root(), "connectivity");
    for (const auto& [token, index] : lane_of) {
      for (const json& next : member(member(connectivity, token), "outgoing")) {
        const auto lane = lane_of.find(id_text(next));
        if (lane != lane_of.end()) builder_.lanes()[index].successors.push_back(lane->second);
      }
      std::ranges::sort(builder_.lanes()[index].successors);
    }
    return {};
  }

  Status append_piece(const json& piece, const JsonPath& path, Polyline& center) {
    const json& start = member(piece, "start_pose");
    const json& lengths = member(piece, "segment_length");
    const std::string shape = text_member(piece, "shape");
    const json& radius = member(piece, "radius");
    const bool is_good =
        start.is_array() && start.size() == 3 && lengths.is_array() &&
        lengths.size() == shape.size() && radius.is_number() &&
        std::ranges::all_of(start, [](const json& v) { return v.is_number(); }) &&
        std::ranges::all_of(lengths, [](const json& v) {
          return v.is_number() && v.get<double>() >= 0.0 && v.get<double>() <= kLongestCurve_m;
        });
    if (!is_good) {
      return fail(
          "{}: found no start_pose, shape, radius and segment_length that fit together, wanted all "
          "four",
          json_.place(path));
    }
    Eigen::Vector2d at(start[0].get<double>(), start[1].get<double>());
    double heading = start[2].get<double>();
    if (center.empty()) center.push_back(at);
    for (size_t i = 0; i < shape.size(); ++i) {
      const double turn = shape[i] == 'L' ? 1.0 : shape[i] == 'R' ? -1.0 : 0.0;
      const double length_m = lengths[i].get<double>();
      const int steps = static_cast<int>(std::ceil(length_m / kCurveStep_m));
      const double step_m = steps > 0 ? length_m / steps : 0.0;
      const double bend = turn / std::max(radius.get<double>(), 0.1);
      for (int step = 0; step < steps; ++step) {
        const double middle = heading + 0.5 * bend * step_m;
        at += step_m * Eigen::Vector2d(std::cos(middle), std::sin(middle));
        heading += bend * step_m;
        if ((at - center.back()).norm() > 0.01) center.push_back(at);
      }
    }
    return {};
  }

  static Lane lane_around(const Polyline& center) {
    Lane lane;
    lane.centerline = center;
    for (size_t i = 0; i < center.size(); ++i) {
      const Eigen::Vector2d along =
          (center[std::min(i + 1, center.size() - 1)] - center[i > 0 ? i - 1 : 0]).normalized();
      const Eigen::Vector2d left(-along.y(), along.x());
      lane.left.emplace_back(center[i] + 0.5 * kLaneWidth_m * left);
      lane.right.emplace_back(center[i] - 0.5 * kLaneWidth_m * left);
    }
    return lane;
  }

  const JsonText& json_;
  MapBuilder builder_;
  std::unordered_map<std::string, Eigen::Vector3d> nodes_;
  Tokens lines_;
  Tokens polygons_;
};

}  // namespace

Result<ImportedMap> parse_nuscenes(std::string_view text, const std::filesystem::path& file,
                                   const ImportOptions& options) {
  const auto document = JsonText::parse(text, file.string());
  if (!document) return tl::unexpected(document.error());
  return NuscenesReader(*document, options).read(file);
}

}  // namespace bevloc
