#include "pipeline/map/formats/geojson.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <GeographicLib/LocalCartesian.hpp>

#include "common/geodetic.h"
#include "common/json_dump.h"
#include "common/median.h"
#include "pipeline/map/class_names.h"
#include "pipeline/map/formats/json_points.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/tangent_plane.h"

namespace bevloc {
namespace {

using nlohmann::json;

/// Rounds to 1e-9 degrees, which are 0.1 mm.
double rounded_deg(double degrees) {
  return std::round(degrees * 1e9) / 1e9;
}

class GeojsonReader {
 public:
  GeojsonReader(const JsonText& document, const ImportOptions& options)
      : json_(document), options_(options), builder_(document.file(), options) {}

  Result<ImportedMap> read(const std::filesystem::path& file) {
    const json& features = member(json_.root(), "features");
    const JsonPath path("/features");
    if (options_.origin) {
      return fail(
          "{}: found an origin for GeoJSON, wanted none: its positions are longitudes and "
          "latitudes already",
          json_.file());
    }
    if (!features.is_array()) {
      return fail("{}: found {}, wanted a list of features", json_.place(path),
                  features.type_name());
    }
    const std::optional<GeoOrigin> stored = stored_origin();
    const GeoOrigin anchor = stored ? *stored : middle_of_lines(features);
    plane_.Reset(anchor.latitude_deg, anchor.longitude_deg);
    for (size_t i = 0; i < features.size(); ++i) {
      if (Status status = read_feature(features[i], path / i, i); !status) {
        return tl::unexpected(status.error());
      }
    }
    link_lanes();
    const std::string name = text_member(json_.root(), "name");
    if (stored) builder_.keep_plane_at(*stored);
    return builder_.finish(name.empty() ? file.stem().string() : name, tangent_projection(anchor));
  }

 private:
  /// What all lines of a feature have in common.
  struct Feature {
    std::string kind;
    std::string where;
    const json& properties;
  };

  Status read_feature(const json& feature, const JsonPath& path, size_t index) {
    const json& geometry = member(feature, "geometry");
    const json& properties = member(feature, "properties");
    const std::string id = id_text(member(feature, "id"));
    const std::string where = "feature " + (id.empty() ? fmt::format("{}", index) : id);
    std::string kind = text_member(properties, "class");
    if (kind.empty()) kind = text_member(properties, "type");
    if (kind.empty()) kind = "no class";
    const JsonPath at = path / "geometry";
    const bool has_bounds =
        member(properties, "left").is_array() || member(properties, "right").is_array();
    if (kind == "lane" && has_bounds && text_member(geometry, "type") == "LineString") {
      return read_lane(member(geometry, "coordinates"), at / "coordinates", properties, path);
    }
    return add_geometry({kind, where, properties}, geometry, at);
  }

  Status add_geometry(const Feature& feature, const json& geometry, const JsonPath& path) {
    const std::string shape = text_member(geometry, "type");
    const json& positions = member(geometry, "coordinates");
    const JsonPath at = path / "coordinates";
    if (shape == "LineString") return add(feature, positions, at);
    if (shape == "MultiLineString") return for_each(positions, at, &GeojsonReader::add, feature);
    if (shape == "Polygon") return add_polygon(feature, positions, at);
    if (shape == "MultiPolygon") {
      return for_each(positions, at, &GeojsonReader::add_polygon, feature);
    }
    if (shape == "GeometryCollection") {
      return for_each(member(geometry, "geometries"), path / "geometries",
                      &GeojsonReader::add_geometry, feature);
    }
    builder_.drop_without_line(feature.kind, feature.where, "no line or polygon");
    return {};
  }

  using AddPart = Status (GeojsonReader::*)(const Feature&, const json&, const JsonPath&);
  Status for_each(const json& parts, const JsonPath& path, AddPart add_part,
                  const Feature& feature) {
    if (!parts.is_array()) return fail("{}: found no list, wanted lists", json_.place(path));
    for (size_t i = 0; i < parts.size(); ++i) {
      Status status = (this->*add_part)(feature, parts[i], path / i);
      if (!status) return status;
    }
    return {};
  }

  /// The first ring is the outline, the others are holes. A hole in a crossing is no crossing.
  Status add_polygon(const Feature& feature, const json& rings, const JsonPath& path) {
    const auto meaning = builder_.meaning_of(feature.kind, meaning_of(feature));
    const bool is_crossing = meaning && meaning->element_class == ElementClass::kPedestrianCrossing;
    if (!is_crossing || !rings.is_array() || rings.empty()) {
      return for_each(rings, path, &GeojsonReader::add, feature);
    }
    for (size_t i = 1; i < rings.size(); ++i) {
      const auto hole = line_at(rings[i], path / i);
      if (!hole) return tl::unexpected(hole.error());
      builder_.drop(feature.kind, feature.where, "a hole in a crossing", length_of(*hole));
    }
    return add(feature, rings[0], path / 0);
  }

  static std::optional<Meaning> meaning_of(const Feature& feature) {
    const auto element_class = class_named(feature.kind);
    if (!element_class) return std::nullopt;
    const auto look = appearance_named(text_member(feature.properties, "appearance"));
    return Meaning{*element_class,
                   look && fits(*look, *element_class) ? *look : Appearance::kUnknown};
  }

  Status add(const Feature& feature, const json& positions, const JsonPath& path) {
    auto line = line_at(positions, path);
    if (!line) return tl::unexpected(line.error());
    builder_.add(feature.kind, feature.where, meaning_of(feature), "no class of bevloc",
                 std::move(*line));
    return {};
  }

  Result<Line3> line_at(const json& positions, const JsonPath& path) const {
    if (!positions.is_array()) {
      return fail("{}: found {}, wanted a list of positions", json_.place(path),
                  positions.type_name());
    }
    Line3 line;
    for (size_t i = 0; i < positions.size(); ++i) {
      const json& position = positions[i];
      const auto place = position_at(position);
      if (!place) {
        return fail("{}: found {:.60}, wanted longitude and latitude in degrees",
                    json_.place(path / i), dump_json(position));
      }
      const Eigen::Vector2d point = point_of(plane_, *place);
      const bool has_height = position.size() > 2 && position[2].is_number();
      line.emplace_back(
          point.x(), point.y(),
          has_height ? position[2].get<double>() : std::numeric_limits<double>::quiet_NaN());
    }
    return line;
  }

  Status read_lane(const json& positions, const JsonPath& at, const json& properties,
                   const JsonPath& path) {
    Lane lane;
    const std::pair<const json*, JsonPath> sources[] = {
        {&positions, at},
        {&member(properties, "left"), path / "properties" / "left"},
        {&member(properties, "right"), path / "properties" / "right"}};
    std::vector<Eigen::Vector2d>* targets[] = {&lane.centerline, &lane.left, &lane.right};
    for (size_t i = 0; i < 3; ++i) {
      const auto line = line_at(*sources[i].first, sources[i].second);
      if (!line) return tl::unexpected(line.error());
      if (line->size() < 2) {
        return fail("{}: found {} positions, wanted at least 2", json_.place(sources[i].second),
                    line->size());
      }
      for (const Eigen::Vector3d& point : *line) targets[i]->emplace_back(point.head<2>());
    }
    const json& speed = member(properties, "speed_mps");
    if (speed.is_number() && speed.get<double>() > 0.0 && speed.get<double>() < 1000.0) {
      lane.speed_limit_mps = speed.get<double>();
    }
    const json& successors = member(properties, "successors");
    states_successors_.push_back(successors.is_array());
    for (const json& next : successors) {
      const bool is_index =
          next.is_number_unsigned() && next.get<uint64_t>() <= std::numeric_limits<uint32_t>::max();
      if (is_index) lane.successors.push_back(next.get<uint32_t>());
    }
    builder_.add_lane(std::move(lane));
    return {};
  }

  /// Finds the successors of the lanes that do not state them.
  void link_lanes() {
    std::vector<Lane>& lanes = builder_.lanes();
    std::vector<Lane> linked = lanes;
    for (Lane& lane : linked) lane.successors.clear();
    link_successors(linked);
    for (size_t i = 0; i < lanes.size(); ++i) {
      if (!states_successors_[i]) lanes[i].successors = std::move(linked[i].successors);
      std::erase_if(lanes[i].successors, [&lanes](uint32_t next) { return next >= lanes.size(); });
    }
  }

  /// A file of to_geojson() says where its origin was, so that the map stays the same.
  std::optional<GeoOrigin> stored_origin() const {
    return position_at(member(json_.root(), "bevloc_origin"));
  }

  /// Reads longitude and latitude in degrees. Returns nothing for any other value.
  static std::optional<GeoOrigin> position_at(const json& value) {
    const bool is_position = value.is_array() && value.size() >= 2 && value[0].is_number() &&
                             value[1].is_number() &&
                             is_on_earth(value[1].get<double>(), value[0].get<double>());
    if (!is_position) return std::nullopt;
    return GeoOrigin{value[1].get<double>(), value[0].get<double>()};
  }

  static bool is_drawn(std::string_view shape) {
    return shape == "LineString" || shape == "MultiLineString" || shape == "Polygon" ||
           shape == "MultiPolygon";
  }

  /// The median of the latitudes and longitudes of all lines and polygons, which a few wrong ones
  /// hardly move. Bounding boxes, points and other members may lie anywhere.
  static GeoOrigin middle_of_lines(const json& features) {
    std::vector<double> latitudes_deg, longitudes_deg;
    const auto add = [&](const auto& self, const json& value) -> void {
      if (const auto position = position_at(value)) {
        latitudes_deg.push_back(position->latitude_deg);
        longitudes_deg.push_back(position->longitude_deg);
        return;
      }
      if (!value.is_array()) return;
      for (const json& part : value) self(self, part);
    };
    const auto add_geometry = [&](const auto& self, const json& geometry) -> void {
      const std::string shape = text_member(geometry, "type");
      if (is_drawn(shape)) add(add, member(geometry, "coordinates"));
      if (shape != "GeometryCollection") return;
      for (const json& part : member(geometry, "geometries")) self(self, part);
    };
    for (const json& feature : features) add_geometry(add_geometry, member(feature, "geometry"));
    if (latitudes_deg.empty()) return {};
    return {median(latitudes_deg), median(longitudes_deg)};
  }

  const JsonText& json_;
  const ImportOptions& options_;
  MapBuilder builder_;
  GeographicLib::LocalCartesian plane_;  ///< tangent plane of the coordinates in the builder
  std::vector<bool> states_successors_;  ///< for each lane, whether it states its successors
};

class GeojsonWriter {
 public:
  GeojsonWriter(const HdMap& map, const std::vector<Heights>& heights_m)
      : map_(map),
        heights_m_(heights_m),
        plane_(map.origin.latitude_deg, map.origin.longitude_deg) {}

  std::string write() {
    json features = json::array();
    for (size_t i = 0; i < map_.elements.size(); ++i) features.push_back(element(i));
    for (const Lane& lane : map_.lanes) features.push_back(feature_of(lane));
    const json collection{{"type", "FeatureCollection"},
                          {"name", map_.name},
                          {"bevloc_origin", {map_.origin.longitude_deg, map_.origin.latitude_deg}},
                          {"features", std::move(features)}};
    return dump_json(collection) + "\n";
  }

 private:
  json positions(const std::vector<Eigen::Vector2d>& points, const Heights& heights_m = {}) const {
    json list = json::array();
    for (size_t i = 0; i < points.size(); ++i) {
      const GeoOrigin place = place_of(plane_, points[i]);
      list.push_back({rounded_deg(place.longitude_deg), rounded_deg(place.latitude_deg)});
      if (heights_m.size() == points.size()) {
        list.back().push_back(std::round(heights_m[i] * 1e3) / 1e3);
      }
    }
    return list;
  }

  json element(size_t index) const {
    const MapElement& element = map_.elements[index];
    const bool ring = is_ring(element.element_class);
    json line =
        positions(element.points, index < heights_m_.size() ? heights_m_[index] : Heights());
    if (ring && !line.empty()) line.push_back(line.front());
    return {
        {"type", "Feature"},
        {"id", index},
        {"properties",
         {{"class", name_of(element.element_class)}, {"appearance", name_of(element.appearance)}}},
        {"geometry",
         {{"type", ring ? "Polygon" : "LineString"},
          {"coordinates", ring ? json::array({line}) : line}}}};
  }

  json feature_of(const Lane& lane) const {
    return {{"type", "Feature"},
            {"properties",
             {{"class", "lane"},
              {"left", positions(lane.left)},
              {"right", positions(lane.right)},
              {"speed_mps", lane.speed_limit_mps},
              {"successors", lane.successors}}},
            {"geometry", {{"type", "LineString"}, {"coordinates", positions(lane.centerline)}}}};
  }

  const HdMap& map_;
  const std::vector<Heights>& heights_m_;
  GeographicLib::LocalCartesian plane_;
};

}  // namespace

Result<ImportedMap> parse_geojson(std::string_view text, const std::filesystem::path& file,
                                  const ImportOptions& options) {
  const auto document = JsonText::parse(text, file.string());
  if (!document) return tl::unexpected(document.error());
  return GeojsonReader(*document, options).read(file);
}

Result<std::string> to_geojson(const ImportedMap& imported) {
  const HdMap& map = imported.map;
  if (!is_known(map.origin)) {
    return fail(
        "{}: found no place on earth, wanted one for GeoJSON; import the map with --origin "
        "LATITUDE,LONGITUDE",
        map.name);
  }
  return GeojsonWriter(map, imported.heights_m).write();
}

}  // namespace bevloc
