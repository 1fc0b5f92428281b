#include "pipeline/map/lanelet2_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <unordered_map>
#include <utility>

#include "common/files.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/map_check.h"
#include "pipeline/map/map_frame.h"
#include "pipeline/map/osm_document.h"

namespace bevloc {
namespace {

enum class LaneletKind : uint8_t { kVehicles, kCrosswalk, kOther };

struct Lanelet {
  const OsmRelation* relation;
  LaneletKind kind;
  const OsmWay* left;
  const OsmWay* right;
};

bool is_yes(std::string_view value) {
  return value == "yes" || value == "true" || value == "1";
}
bool is_no(std::string_view value) {
  return value == "no" || value == "false" || value == "0";
}

/// Explicit participant tags override the participants that the subtype implies.
LaneletKind kind_of(const OsmTags& tags) {
  constexpr std::array<std::string_view, 6> kVehicleSubtypes = {
      "", "road", "highway", "bus_lane", "play_street", "emergency_lane"};
  constexpr std::string_view kParticipant = "participant:";
  const std::string_view subtype = tag_value(tags, "subtype");
  if (subtype == "crosswalk") return LaneletKind::kCrosswalk;
  bool names_participants = false;
  for (const auto& [key, value] : tags) {
    if (!key.starts_with(kParticipant)) continue;
    names_participants = true;
    if (key.starts_with("participant:vehicle") && is_yes(value)) return LaneletKind::kVehicles;
  }
  const bool implies_vehicles = std::find(kVehicleSubtypes.begin(), kVehicleSubtypes.end(),
                                          subtype) != kVehicleSubtypes.end();
  return implies_vehicles && !names_participants ? LaneletKind::kVehicles : LaneletKind::kOther;
}

std::optional<Appearance> boundary_appearance(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, Appearance>, 7> kTypes = {{
      {"curbstone", Appearance::kKerb},
      {"road_border", Appearance::kRoadEdge},
      {"guard_rail", Appearance::kGuardRail},
      {"jersey_barrier", Appearance::kBarrier},
      {"wall", Appearance::kWall},
      {"fence", Appearance::kFence},
      {"hedge", Appearance::kHedge},
  }};
  const auto* entry = std::find_if(kTypes.begin(), kTypes.end(),
                                   [type](const auto& known) { return known.first == type; });
  return entry == kTypes.end() ? std::nullopt : std::optional(entry->second);
}

Appearance divider_appearance(std::string_view subtype) {
  if (subtype == "solid") return Appearance::kSolid;
  if (subtype == "dashed" || subtype == "dashed_dashed") return Appearance::kDashed;
  const bool is_double =
      subtype == "solid_solid" || subtype == "solid_dashed" || subtype == "dashed_solid";
  return is_double ? Appearance::kDoubleSolid : Appearance::kUnknown;
}

/// Parses a speed tag with the unit km/h, mph or m/s; without a unit it is km/h.
std::optional<double> speed_mps(std::string_view text) {
  double value = 0.0;
  const auto number = std::from_chars(text.data(), text.data() + text.size(), value);
  if (number.ec != std::errc() || !(value > 0.0 && value < 1000.0)) return std::nullopt;
  std::string_view unit = text.substr(static_cast<size_t>(number.ptr - text.data()));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  if (unit.empty() || unit == "km/h" || unit == "kmh") return value / 3.6;
  if (unit == "mph") return value * 0.44704;
  if (unit == "m/s") return value;
  return std::nullopt;
}

double length_of(const Polyline& line) {
  double length_m = 0.0;
  for (size_t i = 1; i < line.size(); ++i) length_m += (line[i] - line[i - 1]).norm();
  return length_m;
}

Lane reversed(const Lane& lane) {
  Lane other = lane;
  std::swap(other.left, other.right);
  for (Polyline* line : {&other.left, &other.right, &other.centerline}) {
    std::reverse(line->begin(), line->end());
  }
  return other;
}

/// Converts one document to a map. Stops at the first error.
class Lanelet2Reader {
 public:
  Lanelet2Reader(const OsmDocument& document, NodePositions nodes)
      : document_(document), nodes_(std::move(nodes)) {
    for (const OsmWay& way : document_.ways) ways_[way.id] = &way;
  }

  Result<HdMap> read() {
    for (const auto step : {&Lanelet2Reader::find_lanelets, &Lanelet2Reader::add_lines,
                            &Lanelet2Reader::add_lanes_and_crossings}) {
      if (Status status = (this->*step)(); !status) return tl::unexpected(status.error());
    }
    if (map_.elements.empty() && map_.lanes.empty()) {
      return fail(
          "{}: found no lanelet for vehicles, lane divider, crossing or road boundary in {} ways "
          "and {} relations, wanted a Lanelet2 map",
          document_.file, document_.ways.size(), document_.relations.size());
    }
    link_successors(map_.lanes);
    map_.origin = nodes_.origin;
    return std::move(map_);
  }

 private:
  /// Number of lanelets that a way bounds.
  struct BoundUse {
    int vehicle_lanelets = 0;
    int crosswalks = 0;
  };

  Status find_lanelets() {
    for (const OsmRelation& relation : document_.relations) {
      if (tag_value(relation.tags, "type") != "lanelet") continue;
      const LaneletKind kind = kind_of(relation.tags);
      if (kind == LaneletKind::kOther) continue;
      const auto left = bound(relation, "left");
      if (!left) return tl::unexpected(left.error());
      const auto right = bound(relation, "right");
      if (!right) return tl::unexpected(right.error());
      lanelets_.push_back({&relation, kind, *left, *right});
      for (const OsmWay* way : {*left, *right}) {
        ++(kind == LaneletKind::kCrosswalk ? uses_[way].crosswalks : uses_[way].vehicle_lanelets);
      }
    }
    return {};
  }

  Status add_lines() {
    for (const OsmWay& way : document_.ways) {
      std::optional<MapElement> element = classify(way);
      if (!element) continue;
      Result<Polyline> points = points_of(way);
      if (!points) return tl::unexpected(points.error());
      if (points->size() < 2) continue;
      element->points = std::move(*points);
      map_.elements.push_back(std::move(*element));
    }
    return {};
  }

  Status add_lanes_and_crossings() {
    for (const Lanelet& lanelet : lanelets_) {
      Result<Polyline> left = bound_points(lanelet, *lanelet.left);
      if (!left) return tl::unexpected(left.error());
      Result<Polyline> right = bound_points(lanelet, *lanelet.right);
      if (!right) return tl::unexpected(right.error());
      if (lanelet.kind == LaneletKind::kCrosswalk) {
        add_crossing(lanelet, *left, *right);
      } else {
        add_lanes(lanelet, std::move(*left), std::move(*right));
      }
    }
    return {};
  }

  void add_crossing(const Lanelet& lanelet, const Polyline& left, const Polyline& right) {
    const bool is_zebra = tag_value(lanelet.left->tags, "type") == "zebra_marking" ||
                          tag_value(lanelet.right->tags, "type") == "zebra_marking";
    map_.elements.push_back({ElementClass::kPedestrianCrossing,
                             is_zebra ? Appearance::kZebra : Appearance::kUnknown,
                             ring_between(left, right)});
  }

  void add_lanes(const Lanelet& lanelet, Polyline left, Polyline right) {
    align_bounds(left, right);
    Lane lane;
    lane.centerline = centerline_between(left, right);
    lane.left = std::move(left);
    lane.right = std::move(right);
    const OsmTags& tags = lanelet.relation->tags;
    lane.speed_limit_mps = speed_mps(tag_value(tags, "speed_limit")).value_or(lane.speed_limit_mps);
    map_.lanes.push_back(lane);
    if (is_no(tag_value(tags, "one_way"))) map_.lanes.push_back(reversed(lane));
  }

  /// Class and appearance of a way, without its points. Nothing if the map does not use the way.
  std::optional<MapElement> classify(const OsmWay& way) const {
    const std::string_view type = tag_value(way.tags, "type");
    if (const auto appearance = boundary_appearance(type)) {
      return MapElement{ElementClass::kRoadBoundary, *appearance, {}};
    }
    const auto found = uses_.find(&way);
    const BoundUse use = found == uses_.end() ? BoundUse{} : found->second;
    if (use.vehicle_lanelets == 0 || use.crosswalks > 0) return std::nullopt;
    if (type == "line_thin" || type == "line_thick") {
      return MapElement{
          ElementClass::kLaneDivider, divider_appearance(tag_value(way.tags, "subtype")), {}};
    }
    if (!type.empty()) return std::nullopt;
    return MapElement{
        use.vehicle_lanelets == 1 ? ElementClass::kRoadBoundary : ElementClass::kLaneDivider,
        Appearance::kUnknown,
        {}};
  }

  /// The way with a role in a lanelet. Fails unless there is exactly one.
  Result<const OsmWay*> bound(const OsmRelation& relation, std::string_view role) const {
    const OsmMember* member = nullptr;
    int count = 0;
    for (const OsmMember& candidate : relation.members) {
      if (candidate.role != role || candidate.type != "way") continue;
      member = &candidate;
      ++count;
    }
    if (count != 1) {
      return fail("{}:{}: lanelet {}: found {} ways of role {}, wanted one", document_.file,
                  relation.line, relation.id, count, role);
    }
    const auto way = ways_.find(member->ref);
    if (way == ways_.end()) {
      return fail(
          "{}:{}: lanelet {}: found a reference to way {}, which is missing, wanted its {} "
          "bound in the file",
          document_.file, relation.line, relation.id, member->ref, role);
    }
    return way->second;
  }

  /// Points of a way, without consecutive duplicates.
  Result<Polyline> points_of(const OsmWay& way) const {
    Polyline points;
    for (const int64_t id : way.nodes) {
      const auto node = document_.nodes.find(id);
      if (node == document_.nodes.end()) {
        return fail(
            "{}:{}: way {}: found a reference to node {}, which is missing, wanted all its "
            "nodes in the file",
            document_.file, way.line, way.id, id);
      }
      const auto position = nodes_.of_node.find(id);
      if (position == nodes_.of_node.end()) {
        return fail(
            "{}:{}: node {}: found no coordinates, wanted lat and lon, or local_x and "
            "local_y",
            document_.file, node->second.line, id);
      }
      if (!(position->second.cwiseAbs().maxCoeff() <= kFarthestFromOriginM)) {
        return fail(
            "{}:{}: node {}: found a place ({:g}, {:g}) m from the origin, wanted at most "
            "{:g} m",
            document_.file, node->second.line, id, position->second.x(), position->second.y(),
            kFarthestFromOriginM);
      }
      if (points.empty() || points.back() != position->second) points.push_back(position->second);
    }
    return points;
  }

  Result<Polyline> bound_points(const Lanelet& lanelet, const OsmWay& way) const {
    Result<Polyline> points = points_of(way);
    if (points && points->size() < 2) {
      return fail("{}:{}: way {}: found {} points in this bound of lanelet {}, wanted at least 2",
                  document_.file, way.line, way.id, points->size(), lanelet.relation->id);
    }
    // Centerlines get a point every 2 m, so that a wrong coordinate would fill the memory.
    if (points && length_of(*points) > kLongestPolylineM) {
      return fail("{}:{}: way {}: found {:g} m in this bound of lanelet {}, wanted at most {:g} m",
                  document_.file, way.line, way.id, length_of(*points), lanelet.relation->id,
                  kLongestPolylineM);
    }
    return points;
  }

  const OsmDocument& document_;
  const NodePositions nodes_;
  std::unordered_map<int64_t, const OsmWay*> ways_;
  std::vector<Lanelet> lanelets_;
  std::unordered_map<const OsmWay*, BoundUse> uses_;
  HdMap map_;
};

}  // namespace

Result<HdMap> read_lanelet2(const std::filesystem::path& path) {
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse_lanelet2(*text, path);
}

Result<HdMap> parse_lanelet2(std::string_view text, const std::filesystem::path& file) {
  const Result<OsmDocument> document = parse_osm(text, file.string());
  if (!document) return tl::unexpected(document.error());
  Result<NodePositions> nodes = locate_nodes(*document);
  if (!nodes) return tl::unexpected(nodes.error());
  Result<HdMap> map = Lanelet2Reader(*document, std::move(*nodes)).read();
  if (map) map->name = file.stem().string();
  return map;
}

}  // namespace bevloc
