#include "pipeline/map/formats/opendrive/document.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "pipeline/map/map_check.h"
#include "pipeline/map/speed_unit.h"
#include "pipeline/map/text_lines.h"
#include "pipeline/map/xml_root.h"

namespace bevloc::opendrive {
namespace {

constexpr double kLargestNumber = 1e9;
/// In 1/m, which is a radius of 0.1 m.
constexpr double kMostCurvature = 10.0;
/// A negative length counts as 0 if it is above minus this value.
constexpr double kRounding_m = 1e-6;
/// Limit of the lanes that complete_sides() adds to single-sided sections. It is more than any file
/// needs. Without a limit, the added lanes could fill the memory.
constexpr size_t kMostOtherLanes = 1'000'000;

double mps_from(std::string_view unit) {
  if (unit == "km/h") return 1.0 / kKmh_per_mps;
  if (unit == "mph") return kMps_per_mph;
  return 1.0;
}

/// Reads a number beyond the range of double: 0 if it is too small, infinity if it is too large.
double wide_number(std::string_view text) {
  long double value = std::numeric_limits<long double>::infinity();
  std::from_chars(text.data(), text.data() + text.size(), value);
  return static_cast<double>(value);
}

/// Reads the elements of one file. After the first error every value is zero.
class DocumentReader {
 public:
  DocumentReader(std::string_view text, std::string file) : lines_(text) {
    document_.file = std::move(file);
  }

  Result<Document> read(const pugi::xml_node& root) {
    read_header(root.child("header"));
    for (const pugi::xml_node& road : root.children("road")) {
      if (!error_) document_.roads.push_back(read_road(road));
    }
    if (error_) return tl::unexpected(*error_);
    if (document_.roads.empty()) {
      return fail("{}:{}: found no <road>, wanted at least one", document_.file, line_of(root));
    }
    return std::move(document_);
  }

 private:
  int line_of(const pugi::xml_node& node) const { return lines_.line_at(node.offset_debug()); }

  void reject(const pugi::xml_node& node, std::string_view found, std::string_view wanted) {
    if (error_) return;
    error_ = Error{fmt::format("{}:{}: <{}>: found {}, wanted {}", document_.file, line_of(node),
                               node.name(), found, wanted)};
  }

  /// The number of an attribute. If the attribute is missing and there is a `fallback`, returns it.
  double number(const pugi::xml_node& node, const char* name, double limit = kLargestNumber,
                std::optional<double> fallback = std::nullopt) {
    std::string_view text = node.attribute(name).value();
    if (text.empty() && fallback) return *fallback;
    while (text.starts_with(' ') || text.starts_with('+')) text.remove_prefix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
    double value = 0.0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec == std::errc::result_out_of_range) value = wide_number(text);
    const bool is_number =
        parsed.ec != std::errc::invalid_argument && parsed.ptr == text.data() + text.size();
    if (is_number && std::abs(value) <= limit) return value;
    reject(node, fmt::format("{}=\"{:.40}\"", name, text),
           fmt::format("a number from {:g} to {:g}", -limit, limit));
    return 0.0;
  }

  double length(const pugi::xml_node& node, const char* name) {
    const double value = number(node, name, kLongestPolylineM);
    if (value < -kRounding_m) reject(node, fmt::format("{}={:g}", name, value), "0 or more");
    return std::max(value, 0.0);
  }

  void read_header(const pugi::xml_node& header) {
    if (!header) return;
    const double major = number(header, "revMajor", 100.0, 1.0);
    if (major != 1.0) reject(header, fmt::format("revMajor={:g}", major), "OpenDRIVE 1");
    if (const pugi::xml_node reference = header.child("geoReference")) {
      document_.georeference = reference.text().get();
      document_.georeference_line = line_of(reference);
    }
    if (const pugi::xml_node offset = header.child("offset")) {
      document_.offset = {number(offset, "x", kLargestNumber, 0.0),
                          number(offset, "y", kLargestNumber, 0.0)};
      document_.offset_heading_rad = number(offset, "hdg", 10.0, 0.0);
    }
  }

  Cubic read_cubic(const pugi::xml_node& node, const char* start) {
    return {number(node, start, kLargestNumber), number(node, "a"), number(node, "b"),
            number(node, "c"), number(node, "d")};
  }

  Cubics read_cubics(const pugi::xml_node& parent, const char* name, const char* start) {
    Cubics cubics;
    for (const pugi::xml_node& node : parent.children(name)) {
      cubics.push_back(read_cubic(node, start));
    }
    std::ranges::stable_sort(cubics, {}, &Cubic::start_m);
    return cubics;
  }

  Geometry read_geometry(const pugi::xml_node& node) {
    Geometry geometry;
    geometry.start_m = length(node, "s");
    geometry.length_m = length(node, "length");
    geometry.origin = {number(node, "x"), number(node, "y")};
    geometry.heading_rad = number(node, "hdg", 1e4);
    if (node.child("line")) return geometry;
    if (const pugi::xml_node arc = node.child("arc")) {
      geometry.kind = Geometry::Kind::kArc;
      geometry.start_curvature = number(arc, "curvature", kMostCurvature);
    } else if (const pugi::xml_node spiral = node.child("spiral")) {
      geometry.kind = Geometry::Kind::kSpiral;
      geometry.start_curvature = number(spiral, "curvStart", kMostCurvature);
      geometry.end_curvature = number(spiral, "curvEnd", kMostCurvature);
    } else if (const pugi::xml_node poly = node.child("poly3")) {
      geometry.kind = Geometry::Kind::kPoly3;
      geometry.v = {0.0, number(poly, "a"), number(poly, "b"), number(poly, "c"),
                    number(poly, "d")};
    } else if (const pugi::xml_node param = node.child("paramPoly3")) {
      geometry.kind = Geometry::Kind::kParamPoly3;
      geometry.u = {0.0, number(param, "aU"), number(param, "bU"), number(param, "cU"),
                    number(param, "dU")};
      geometry.v = {0.0, number(param, "aV"), number(param, "bV"), number(param, "cV"),
                    number(param, "dV")};
      geometry.is_normalized = std::strcmp(param.attribute("pRange").value(), "arcLength") != 0;
    } else {
      reject(node, "no known kind of geometry", "line, arc, spiral, poly3 or paramPoly3");
    }
    place_knots(geometry);
    return geometry;
  }

  std::optional<double> read_speed(const pugi::xml_node& parent) {
    const pugi::xml_node speed = parent.child("speed");
    double value = 0.0;
    const std::string_view text = speed.attribute("max").value();
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    // "no limit" and "undefined" are allowed.
    if (parsed.ec != std::errc() || !(value > 0.0 && value < 500.0)) return std::nullopt;
    return value * mps_from(speed.attribute("unit").value());
  }

  RoadMark read_mark(const pugi::xml_node& node) {
    RoadMark mark;
    mark.start_m = number(node, "sOffset", kLargestNumber, 0.0);
    mark.type = node.attribute("type").value();
    double sum_m = 0.0;
    int lines = 0;
    for (const pugi::xml_node& line : node.child("type").children("line")) {
      sum_m += number(line, "tOffset", kLargestNumber, 0.0);
      ++lines;
    }
    if (lines > 0) mark.offset_m = sum_m / lines;
    mark.sways = read_cubics(node, "sway", "ds");
    return mark;
  }

  LaneSpec read_lane(const pugi::xml_node& node) {
    LaneSpec lane;
    lane.id = static_cast<int>(number(node, "id", 1000.0));
    lane.line = line_of(node);
    lane.type = node.attribute("type").value();
    lane.widths = read_cubics(node, "width", "sOffset");
    lane.borders = read_cubics(node, "border", "sOffset");
    for (const pugi::xml_node& mark : node.children("roadMark")) {
      lane.marks.push_back(read_mark(mark));
    }
    std::ranges::stable_sort(lane.marks, {}, &RoadMark::start_m);
    lane.speed_mps = read_speed(node);
    return lane;
  }

  LaneSection read_section(const pugi::xml_node& node) {
    LaneSection section;
    section.start_m = length(node, "s");
    section.line = line_of(node);
    for (const char* side : {"right", "center", "left"}) {
      for (const pugi::xml_node& lane : node.child(side).children("lane")) {
        section.lanes.push_back(read_lane(lane));
      }
    }
    std::ranges::stable_sort(section.lanes, {}, &LaneSpec::id);
    const auto has = [&](int id) {
      return std::ranges::count(section.lanes, id, &LaneSpec::id) == 1;
    };
    for (const LaneSpec& lane : section.lanes) {
      // No lane between a lane and the centre may be missing.
      if (!has(lane.id) || (lane.id != 0 && !has(lane.id > 0 ? lane.id - 1 : lane.id + 1))) {
        reject(node, fmt::format("lane {} without its inner neighbour, or twice", lane.id),
               "lanes with consecutive ids from 0");
      }
    }
    if (!has(0)) {
      reject(node, "no centre lane", "one of id 0");
      return section;
    }
    const bool has_both = section.lanes.front().id < 0 && section.lanes.back().id > 0;
    section.is_single_side =
        node.attribute("singleSide").as_bool() && !has_both && section.lanes.size() > 1;
    return section;
  }

  /// Reads an object. A wrong number of a crosswalk is an error. A wrong number of another object
  /// is only noted, because the map may not need the object.
  RoadObject read_object(const pugi::xml_node& node) {
    const bool was_right = !error_;
    RoadObject object = read_any_object(node);
    if (was_right && error_ && !is_crosswalk(object)) {
      object.fault = std::move(error_->message);
      error_.reset();
    }
    return object;
  }

  RoadObject read_any_object(const pugi::xml_node& node) {
    RoadObject object;
    object.id = node.attribute("id").value();
    object.name = node.attribute("name").value();
    object.type = node.attribute("type").value();
    object.line = line_of(node);
    object.s_m = number(node, "s", kLargestNumber, 0.0);
    object.t_m = number(node, "t", kLargestNumber, 0.0);
    object.z_m = number(node, "zOffset", kLargestNumber, 0.0);
    object.heading_rad = number(node, "hdg", 1e4, 0.0);
    object.length_m = number(node, "length", kLargestNumber, 0.0);
    object.width_m = number(node, "width", kLargestNumber, 0.0);
    const pugi::xml_node outlines = node.child("outlines");
    const pugi::xml_node parent = outlines.child("outline") ? outlines : node;
    for (const pugi::xml_node& outline : parent.children("outline")) {
      // An inner outline is a hole.
      if (!outline.attribute("outer").as_bool(true)) continue;
      object.outlines.push_back({read_corners(outline), outline.attribute("closed").as_bool(true)});
      if (object.outlines.back().corners.empty()) object.outlines.pop_back();
    }
    for (const pugi::xml_node& repeat : node.children("repeat")) {
      if (is_crosswalk(object)) object.repeats.push_back(read_repeat(repeat, object));
    }
    return object;
  }

  std::vector<Corner> read_corners(const pugi::xml_node& node) {
    std::vector<Corner> corners;
    for (const pugi::xml_node& corner : node.children()) {
      if (std::strcmp(corner.name(), "cornerLocal") == 0) {
        corners.push_back(
            {true,
             {number(corner, "u"), number(corner, "v"), number(corner, "z", kLargestNumber, 0.0)}});
      } else if (std::strcmp(corner.name(), "cornerRoad") == 0) {
        corners.push_back({false,
                           {number(corner, "s"), number(corner, "t"),
                            number(corner, "dz", kLargestNumber, 0.0)}});
      }
    }
    return corners;
  }

  Repeat read_repeat(const pugi::xml_node& node, const RoadObject& object) {
    const auto ends = [&](const char* first, const char* last, double fallback) {
      return std::array<double, 2>{number(node, first, kLargestNumber, fallback),
                                   number(node, last, kLargestNumber, fallback)};
    };
    Repeat repeat;
    repeat.start_m = number(node, "s", kLargestNumber, object.s_m);
    repeat.length_m = number(node, "length", kLargestNumber, 0.0);
    repeat.distance_m = number(node, "distance", kLargestNumber, 0.0);
    repeat.t_m = ends("tStart", "tEnd", object.t_m);
    repeat.z_m = ends("zOffsetStart", "zOffsetEnd", object.z_m);
    repeat.object_length_m = ends("lengthStart", "lengthEnd", object.length_m);
    repeat.object_width_m = ends("widthStart", "widthEnd", object.width_m);
    return repeat;
  }

  Road read_road(const pugi::xml_node& node) {
    Road road;
    road.id = node.attribute("id").value();
    road.line = line_of(node);
    road.length_m = length(node, "length");
    const std::string_view junction = node.attribute("junction").value();
    road.is_in_junction = !junction.empty() && junction != "-1";
    road.drives_left = std::strcmp(node.attribute("rule").value(), "LHT") == 0;
    road.speed_mps = read_speed(node.child("type"));
    for (const pugi::xml_node& geometry : node.child("planView").children("geometry")) {
      road.geometries.push_back(read_geometry(geometry));
    }
    if (road.geometries.empty()) reject(node, "no <geometry>", "a <planView> with at least one");
    std::ranges::stable_sort(road.geometries, {}, &Geometry::start_m);
    road.stretches = stretches_of(road);
    road.elevations = read_cubics(node.child("elevationProfile"), "elevation", "s");
    const pugi::xml_node lanes = node.child("lanes");
    road.lane_offsets = read_cubics(lanes, "laneOffset", "s");
    for (const pugi::xml_node& section : lanes.children("laneSection")) {
      road.sections.push_back(read_section(section));
    }
    if (road.sections.empty()) reject(node, "no <laneSection>", "at least one");
    join_sections(lanes, road);
    snap_lane_offsets(road);
    for (const pugi::xml_node& object : node.child("objects").children("object")) {
      road.objects.push_back(read_object(object));
    }
    return road;
  }

  /// Orders the sections, completes them, and ends each where the next begins.
  void join_sections(const pugi::xml_node& lanes, Road& road) {
    std::ranges::stable_sort(road.sections, {}, &LaneSection::start_m);
    if (error_) return;
    size_t most = 0;
    for (const LaneSection& section : road.sections) {
      most = std::max(most, section.lanes.size());
      if (section.is_single_side) other_lanes_ += most;
    }
    if (other_lanes_ > kMostOtherLanes) {
      reject(
          lanes, fmt::format("{} lanes beside sections with singleSide", other_lanes_),
          fmt::format("at most {} in the file; write both sides into one section, or cut the map "
                      "into several files",
                      kMostOtherLanes));
      return;
    }
    complete_sides(road.sections);
    for (size_t i = 0; i < road.sections.size(); ++i) {
      const bool is_last = i + 1 == road.sections.size();
      road.sections[i].end_m =
          is_last ? road.length_m : std::min(road.sections[i + 1].start_m, road.length_m);
    }
  }

  LineFinder lines_;
  Document document_;
  size_t other_lanes_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Result<Document> parse_document(std::string_view text, std::string file) {
  pugi::xml_document xml;
  const auto root = parse_xml(text, file, {.name = "OpenDRIVE", .root = "OpenDRIVE"}, xml);
  if (!root) return tl::unexpected(root.error());
  return DocumentReader(text, std::move(file)).read(*root);
}

}  // namespace bevloc::opendrive
