#include "pipeline/map/lanelet2_reader.h"

#include <algorithm>
#include <array>
#include <optional>
#include <unordered_map>
#include <utility>

#include "pipeline/map/bound_neighbours.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/lanelet_tags.h"
#include "pipeline/map/map_check.h"
#include "pipeline/map/map_frame.h"
#include "pipeline/map/osm_document.h"

namespace bevloc {
namespace {

/// What bounds a lanelet on one side.
struct Bound {
  std::vector<const OsmWay*> ways;
  Polyline points;
};

struct Lanelet {
  const OsmRelation* relation;
  LaneletKind kind;
  Bound left;
  Bound right;
};

/// Converts one document to a map.
class Lanelet2Reader {
 public:
  Lanelet2Reader(const OsmDocument& document, NodePositions nodes, const ClassTable& classes,
                 ImportReport report)
      : document_(document),
        nodes_(std::move(nodes)),
        classes_(classes),
        report_(std::move(report)) {
    for (const OsmWay& way : document_.ways) ways_[way.id] = &way;
  }

  Result<ImportedMap> read() {
    find_lanelets();
    for (const Lanelet& lanelet : lanelets_) add_lanelet(lanelet);
    read_lines();
    for (const OsmWay& way : document_.ways) add_line(way);
    if (map_.elements.empty() && map_.lanes.empty()) return nothing_found();
    link_successors(map_.lanes);
    map_.origin = nodes_.origin;
    return ImportedMap{std::move(map_), std::move(report_), std::move(heights_m_)};
  }

 private:
  /// Number of lanelets that a way bounds.
  struct BoundUse {
    int vehicle_lanelets = 0;
    int crosswalks = 0;
    int others = 0;
  };

  tl::unexpected<Error> nothing_found() const {
    if (!map_.left_out.empty()) {
      return fail("{}; nothing else in the file can be used", map_.left_out.front());
    }
    return fail(
        "{}: found no lanelet for vehicles, lane divider, crossing or road boundary in {} ways "
        "and {} relations, wanted a Lanelet2 map",
        document_.file, document_.ways.size(), document_.relations.size());
  }

  void find_lanelets() {
    for (const OsmRelation& relation : document_.relations) {
      const bool is_lanelet = tag_value(relation.tags, "type") == "lanelet";
      const LaneletKind kind = is_lanelet ? kind_of(relation.tags) : LaneletKind::kOther;
      if (is_lanelet) count_uses(relation, kind);
      if (kind == LaneletKind::kOther) {
        report_.note_without_line(relation_kind(relation.tags), "not for vehicles, no crossing",
                                  place_of(relation));
        continue;
      }
      Result<Bound> left = bound(relation, "left");
      Result<Bound> right = left ? bound(relation, "right") : tl::unexpected(left.error());
      if (!right) {
        map_.left_out.push_back(right.error().message);
        continue;
      }
      lanelets_.push_back({&relation, kind, std::move(*left), std::move(*right)});
    }
  }

  static std::string place_of(const OsmRelation& relation) {
    return fmt::format("relation {} (line {})", relation.id, relation.line);
  }

  void count_uses(const OsmRelation& relation, LaneletKind kind) {
    for (const OsmMember& member : relation.members) {
      if (member.type != "way" || (member.role != "left" && member.role != "right")) continue;
      BoundUse& use = uses_[member.ref];
      use.vehicle_lanelets += kind == LaneletKind::kVehicles ? 1 : 0;
      use.crosswalks += kind == LaneletKind::kCrosswalk ? 1 : 0;
      use.others += kind == LaneletKind::kOther ? 1 : 0;
    }
  }

  void add_lanelet(const Lanelet& lanelet) {
    if (lanelet.kind == LaneletKind::kCrosswalk) {
      add_crossing(lanelet);
    } else {
      add_lanes(lanelet);
    }
  }

  void add_crossing(const Lanelet& lanelet) {
    const auto is_zebra = [](const OsmWay* way) {
      return tag_value(way->tags, "type") == "zebra_marking";
    };
    const bool has_zebra = std::ranges::any_of(lanelet.left.ways, is_zebra) ||
                           std::ranges::any_of(lanelet.right.ways, is_zebra);
    MapElement crossing{ElementClass::kPedestrianCrossing,
                        has_zebra ? Appearance::kZebra : Appearance::kUnknown,
                        ring_between(lanelet.left.points, lanelet.right.points)};
    const std::string where =
        fmt::format("lanelet {} (line {})", lanelet.relation->id, lanelet.relation->line);
    if (area_of_ring_m2(crossing.points) < kLeastCrossing_m2) {
      map_.left_out.push_back(fmt::format(
          "{}:{}: lanelet {}: found bounds without an area between them, wanted a crossing",
          document_.file, lanelet.relation->line, lanelet.relation->id));
      report_.note("lanelet crosswalk", std::nullopt, "left out, see below", 0.0, where);
      return;
    }
    std::vector<const OsmWay*> ways = lanelet.left.ways;
    ways.insert(ways.end(), lanelet.right.ways.begin(), lanelet.right.ways.end());
    Heights heights_m = heights_at(crossing.points, ways, document_, nodes_);
    take(std::move(crossing), "lanelet crosswalk", where, std::move(heights_m));
  }

  /// Adds an element with the meaning that the class table gives its kind. Drops it if the table
  /// says so, or if it does not have the shape that this meaning needs.
  void take(MapElement element, const std::string& kind, const std::string& where,
            Heights heights_m) {
    std::optional<Meaning> meaning = Meaning{element.element_class, element.appearance};
    const auto* rule = classes_.rule_for(kind);
    if (rule != nullptr) meaning = rule->becomes;
    std::string_view why = rule != nullptr ? "by the class table" : "";
    double length_m = length_of(element);
    if (meaning) {
      const bool was_ring = is_ring(element.element_class);
      element.element_class = meaning->element_class;
      element.appearance = meaning->appearance;
      if (was_ring) close(element.points, heights_m);
      const std::string_view fault = shape_element(element, heights_m);
      if (fault.empty()) {
        length_m = length_of(element);
      } else {
        meaning.reset();
        why = fault;
      }
    }
    report_.note(kind, meaning, why, length_m, where);
    if (!meaning) return;
    map_.elements.push_back(std::move(element));
    heights_m_.push_back(std::move(heights_m));
  }

  /// Repeats the first corner of a ring at its end.
  static void close(Polyline& ring, Heights& heights_m) {
    ring.push_back(ring.front());
    if (!heights_m.empty()) heights_m.push_back(heights_m.front());
  }

  static std::string name_of(const OsmWay& way) {
    return fmt::format("way {} (line {})", way.id, way.line);
  }

  /// Reports a way that gives no line. A way whose nodes are missing has no length.
  void drop(const OsmWay& way, std::string_view why) {
    const Result<Polyline> points = points_of(way, document_, nodes_);
    report_.note(way_kind(way.tags), std::nullopt, why, points ? polyline_length(*points) : 0.0,
                 name_of(way));
  }

  void add_lanes(const Lanelet& lanelet) {
    Lane lane;
    lane.left = lanelet.left.points;
    lane.right = lanelet.right.points;
    align_bounds(lane.left, lane.right);
    lane.centerline = centerline_between(lane.left, lane.right);
    const OsmTags& tags = lanelet.relation->tags;
    lane.speed_limit_mps = speed_mps(tag_value(tags, "speed_limit")).value_or(lane.speed_limit_mps);
    if (!can_be_driven(lane.centerline)) {
      map_.left_out.push_back(
          fmt::format("{}:{}: lanelet {}: found a length of {:g} m, wanted {:g} m to {:g} m",
                      document_.file, lanelet.relation->line, lanelet.relation->id,
                      polyline_length(lane.centerline), kShortestLaneM, kLongestPolylineM));
      return;
    }
    map_.lanes.push_back(lane);
    if (is_no(tag_value(tags, "one_way"))) map_.lanes.push_back(reversed(lane));
  }

  /// Reads the points of all ways that may be lines, and finds which run beside each other.
  void read_lines() {
    for (const Lanelet& lanelet : lanelets_) {
      std::vector<int64_t> own;
      for (const OsmWay* way : lanelet.left.ways) own.push_back(way->id);
      for (const OsmWay* way : lanelet.right.ways) own.push_back(way->id);
      beside_.add_lanelet(own);
    }
    for (const OsmWay& way : document_.ways) {
      const bool is_boundary = boundary_appearance(tag_value(way.tags, "type")).has_value();
      if (!is_boundary && use_of(way).vehicle_lanelets == 0) continue;
      const Result<Polyline> points = points_of(way, document_, nodes_);
      if (points && polyline_length(*points) <= kLongestPolylineM) {
        beside_.add_line(way.id, *points, is_boundary);
      }
    }
  }

  void add_line(const OsmWay& way) {
    const std::string kind = way_kind(way.tags);
    std::optional<MapElement> element = classify(way);
    const auto* rule = classes_.rule_for(kind);
    if (!element && rule != nullptr && rule->becomes) element = MapElement{};
    if (!element) return drop(way, "no line of the road");
    Result<Polyline> points = points_of(way, document_, nodes_);
    if (!points) {
      map_.left_out.push_back(points.error().message);
      return drop(way, "left out, see below");
    }
    if (points->size() < 2) return drop(way, "too few points");
    if (polyline_length(*points) > kLongestPolylineM) {
      map_.left_out.push_back(fmt::format("{}:{}: way {}: found {:g} m, wanted at most {:g} m",
                                          document_.file, way.line, way.id,
                                          polyline_length(*points), kLongestPolylineM));
      return drop(way, "left out, see below");
    }
    element->points = std::move(*points);
    const std::string_view why_not = judge_by_neighbours(way, *element);
    if (!why_not.empty()) return drop(way, why_not);
    Heights heights_m = heights_of(way, document_, nodes_, element->points.size());
    take(std::move(*element), kind, name_of(way), std::move(heights_m));
  }

  const BoundUse& use_of(const OsmWay& way) const {
    static const BoundUse kUnused;
    const auto found = uses_.find(way.id);
    return found == uses_.end() ? kUnused : found->second;
  }

  /// Class and appearance of a way by its tags and use, without its points. Returns nothing if the
  /// map does not use the way.
  std::optional<MapElement> classify(const OsmWay& way) const {
    const std::string_view type = tag_value(way.tags, "type");
    if (const auto appearance = boundary_appearance(type)) {
      return MapElement{ElementClass::kRoadBoundary, *appearance, {}};
    }
    const BoundUse& use = use_of(way);
    if (use.crosswalks > 0) return std::nullopt;
    if (type == "line_thin" || type == "line_thick") {
      if (use.vehicle_lanelets == 0 && use.others > 0) return std::nullopt;
      return MapElement{
          ElementClass::kLaneDivider, divider_appearance(tag_value(way.tags, "subtype")), {}};
    }
    if (!type.empty() || use.vehicle_lanelets == 0) return std::nullopt;
    return MapElement{
        use.vehicle_lanelets == 1 ? ElementClass::kRoadBoundary : ElementClass::kLaneDivider,
        Appearance::kUnknown,
        {}};
  }

  /// Corrects the class of lines that bound one lanelet for vehicles by what runs beside them.
  /// Returns why the line does not belong to the map, or "".
  std::string_view judge_by_neighbours(const OsmWay& way, MapElement& element) {
    if (use_of(way).vehicle_lanelets != 1) return "";
    const bool has_type = !tag_value(way.tags, "type").empty();
    if (has_type && element.element_class == ElementClass::kLaneDivider) {
      if (!beside_.is_edge_of_road(way.id, element.points)) return "";
      element.element_class = ElementClass::kRoadBoundary;
      element.appearance = Appearance::kRoadEdge;
    } else if (!has_type) {
      if (beside_.is_on_boundary(way.id, element.points)) return "a road boundary is the same line";
      if (!beside_.is_on_bound(way.id, element.points)) return "";
      element.element_class = ElementClass::kLaneDivider;
      if (beside_.is_second_of_a_pair(way.id, element.points)) {
        return "the neighbouring lanelet has the same line";
      }
    }
    return "";
  }

  /// The ways with a role in a lanelet, as one line.
  Result<Bound> bound(const OsmRelation& relation, std::string_view role) const {
    Bound bound;
    std::vector<Polyline> pieces;
    for (const OsmMember& member : relation.members) {
      if (member.role != role || member.type != "way") continue;
      const auto way = ways_.find(member.ref);
      if (way == ways_.end()) {
        return fail(
            "{}:{}: lanelet {}: found a reference to way {}, which is missing, wanted its {} "
            "bound in the file",
            document_.file, relation.line, relation.id, member.ref, role);
      }
      Result<Polyline> points = bound_points(relation, *way->second);
      if (!points) return tl::unexpected(points.error());
      bound.ways.push_back(way->second);
      pieces.push_back(std::move(*points));
    }
    if (pieces.empty()) {
      return fail("{}:{}: lanelet {}: found no way of role {}, wanted one or more", document_.file,
                  relation.line, relation.id, role);
    }
    std::optional<Polyline> line = joined(std::move(pieces));
    if (!line) {
      return fail("{}:{}: lanelet {}: found {} ways of role {} that do not join, wanted one line",
                  document_.file, relation.line, relation.id, bound.ways.size(), role);
    }
    bound.points = std::move(*line);
    return bound;
  }

  Result<Polyline> bound_points(const OsmRelation& relation, const OsmWay& way) const {
    Result<Polyline> points = points_of(way, document_, nodes_);
    if (points && points->size() < 2) {
      return fail("{}:{}: way {}: found {} points in this bound of lanelet {}, wanted at least 2",
                  document_.file, way.line, way.id, points->size(), relation.id);
    }
    // Centerlines get a point every 2 m, so a wrong coordinate would fill the memory.
    if (points && polyline_length(*points) > kLongestPolylineM) {
      return fail("{}:{}: way {}: found {:g} m in this bound of lanelet {}, wanted at most {:g} m",
                  document_.file, way.line, way.id, polyline_length(*points), relation.id,
                  kLongestPolylineM);
    }
    return points;
  }

  const OsmDocument& document_;
  const NodePositions nodes_;
  const ClassTable& classes_;
  std::unordered_map<int64_t, const OsmWay*> ways_;
  std::vector<Lanelet> lanelets_;
  std::unordered_map<int64_t, BoundUse> uses_;  ///< uses of each way
  BoundNeighbours beside_;
  HdMap map_;
  std::vector<Heights> heights_m_;  ///< one for each element
  ImportReport report_;
};

/// Gives a map without a place on earth the origin of the options, if there is one. Moves the frame
/// of a map that is far from zero.
Status place_on_earth(NodePositions& nodes, const ImportOptions& options, const std::string& file,
                      ImportReport& report) {
  if (is_known(nodes.origin)) {
    if (!options.origin) return {};
    return fail(
        "{}: found an origin for a map whose nodes have latitude and longitude, wanted none", file);
  }
  if (!options.origin) {
    if (const auto shift = move_to_middle(nodes)) report.remark_shift(*shift);
    return {};
  }
  const Eigen::Vector2d middle = middle_of(nodes);
  if (!is_near_origin(middle)) return far_from_origin(file, middle);
  report.remark_far_origin(middle);
  nodes.origin = *options.origin;
  move_to_middle(nodes);
  return {};
}

}  // namespace

Result<ImportedMap> parse_lanelet2(std::string_view text, const std::filesystem::path& file,
                                   const ImportOptions& options) {
  const Result<OsmDocument> document = parse_osm(text, file.string());
  if (!document) return tl::unexpected(document.error());
  Result<NodePositions> nodes = locate_nodes(*document);
  if (!nodes) return tl::unexpected(nodes.error());
  ImportReport report;
  if (!nodes->remark.empty()) report.remark(nodes->remark);
  if (Status status = place_on_earth(*nodes, options, file.string(), report); !status) {
    return tl::unexpected(status.error());
  }
  const ClassTable none;
  const ClassTable& classes = options.classes != nullptr ? *options.classes : none;
  Result<ImportedMap> imported =
      Lanelet2Reader(*document, std::move(*nodes), classes, std::move(report)).read();
  if (!imported) return imported;
  if (Status status = check_rules(classes, imported->report, file.string()); !status) {
    return tl::unexpected(status.error());
  }
  imported->map.name = file.stem().string();
  return imported;
}

}  // namespace bevloc
