#include "pipeline/map/osm_document.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_set>

#include "common/number_text.h"
#include "pipeline/map/text_lines.h"
#include "pipeline/map/xml_root.h"

namespace bevloc {
namespace {

template <typename T>
std::optional<T> number_from(std::string_view text) {
  return parse_number<T>(trimmed_number(text));
}

/// Reads the tag `ele` in metres, with or without the unit. Returns nothing for anything else,
/// because a map without heights serves as well.
std::optional<double> height_from(std::string_view text) {
  constexpr double kHighest_m = 1e5;
  text = trimmed_number(text);
  if (text.ends_with('m')) text.remove_suffix(1);
  const auto height_m = number_from<double>(text);
  return height_m && std::abs(*height_m) <= kHighest_m ? height_m : std::nullopt;
}

/// Zone, band and square ("54SUE") of an MGRS code: what comes before its numbers. White space does
/// not count.
std::string mgrs_square_of(std::string code) {
  std::erase_if(code, [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; });
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  size_t end = 0;
  while (end < code.size() && is_digit(code[end])) ++end;
  while (end < code.size() && !is_digit(code[end])) ++end;
  return code.substr(0, end);
}

/// Reads the elements of one file. Stops at the first error.
class OsmReader {
 public:
  OsmReader(std::string_view text, std::string file) : lines_(text) {
    document_.file = std::move(file);
  }

  Result<OsmDocument> read(const pugi::xml_node& osm) {
    for (const pugi::xml_node& element : osm.children()) {
      if (std::strcmp(element.attribute("action").value(), "delete") == 0) continue;
      const std::string_view kind = element.name();
      Status status;
      if (kind == "node") status = read_node(element);
      if (kind == "way") status = read_way(element);
      if (kind == "relation") status = read_relation(element);
      if (!status) return tl::unexpected(status.error());
    }
    return std::move(document_);
  }

 private:
  int line_of(const pugi::xml_node& node) const { return lines_.line_at(node.offset_debug()); }

  /// An attribute that contains an id.
  Result<int64_t> id_in(const pugi::xml_node& element, const char* attribute) const {
    const std::string_view text = element.attribute(attribute).value();
    if (const auto id = number_from<int64_t>(text)) return *id;
    return fail("{}:{}: {}: found {}=\"{}\", wanted a whole number", document_.file,
                line_of(element), element.name(), attribute, text);
  }

  /// The id of the element, which must be unique among elements of its kind.
  Result<int64_t> new_id(const pugi::xml_node& element, std::unordered_set<int64_t>& seen) const {
    Result<int64_t> id = id_in(element, "id");
    if (id && !seen.insert(*id).second) {
      return fail("{}:{}: {} {}: found this id a second time, wanted each id once", document_.file,
                  line_of(element), element.name(), *id);
    }
    return id;
  }

  /// A coordinate from -limit to limit, or nothing for "".
  Result<std::optional<double>> coordinate(const pugi::xml_node& place, int64_t node_id,
                                           std::string_view name, std::string_view text,
                                           double limit) const {
    if (text.empty()) return std::nullopt;
    const auto value = number_from<double>(text);
    if (value && std::abs(*value) <= limit) return value;
    return fail("{}:{}: node {}: found {} \"{}\", wanted a number from {} to {}", document_.file,
                line_of(place), node_id, name, text, -limit, limit);
  }

  Status read_node(const pugi::xml_node& element) {
    constexpr double kMaxLocalM = 1e8;
    const Result<int64_t> id = new_id(element, node_ids_);
    if (!id) return tl::unexpected(id.error());
    OsmNode& node = document_.nodes[*id];
    node.line = line_of(element);
    const auto store = [&](const pugi::xml_node& place, const char* name, const char* text,
                           double limit, std::optional<double>& target) -> Status {
      auto value = coordinate(place, *id, name, text, limit);
      if (!value) return tl::unexpected(value.error());
      target = *value;
      return {};
    };
    Status status =
        store(element, "lat", element.attribute("lat").value(), 90.0, node.latitude_deg);
    if (status) {
      status = store(element, "lon", element.attribute("lon").value(), 180.0, node.longitude_deg);
    }
    for (const pugi::xml_node& tag : element.children("tag")) {
      const std::string_view key = tag.attribute("k").value();
      const char* value = tag.attribute("v").value();
      if (status && key == "local_x") {
        status = store(tag, "local_x", value, kMaxLocalM, node.local_x_m);
      } else if (status && key == "local_y") {
        status = store(tag, "local_y", value, kMaxLocalM, node.local_y_m);
      } else if (key == "ele") {
        node.height_m = height_from(value);
      } else if (key == "mgrs_code") {
        node.mgrs_square = mgrs_square_of(value);
      }
    }
    return status;
  }

  Status read_way(const pugi::xml_node& element) {
    const Result<int64_t> id = new_id(element, way_ids_);
    if (!id) return tl::unexpected(id.error());
    OsmWay way{*id, line_of(element), {}, tags_of(element)};
    for (const pugi::xml_node& reference : element.children("nd")) {
      const Result<int64_t> node = id_in(reference, "ref");
      if (!node) return tl::unexpected(node.error());
      way.nodes.push_back(*node);
    }
    document_.ways.push_back(std::move(way));
    return {};
  }

  Status read_relation(const pugi::xml_node& element) {
    const Result<int64_t> id = new_id(element, relation_ids_);
    if (!id) return tl::unexpected(id.error());
    OsmRelation relation{*id, line_of(element), {}, tags_of(element)};
    for (const pugi::xml_node& member : element.children("member")) {
      const Result<int64_t> ref = id_in(member, "ref");
      if (!ref) return tl::unexpected(ref.error());
      relation.members.push_back(
          {member.attribute("type").value(), member.attribute("role").value(), *ref});
    }
    document_.relations.push_back(std::move(relation));
    return {};
  }

  static OsmTags tags_of(const pugi::xml_node& element) {
    OsmTags tags;
    for (const pugi::xml_node& tag : element.children("tag")) {
      tags[tag.attribute("k").value()] = tag.attribute("v").value();
    }
    return tags;
  }

  OsmDocument document_;
  LineFinder lines_;
  std::unordered_set<int64_t> node_ids_;
  std::unordered_set<int64_t> way_ids_;
  std::unordered_set<int64_t> relation_ids_;
};

}  // namespace

std::string_view tag_value(const OsmTags& tags, std::string_view key) {
  const auto tag = tags.find(key);
  return tag == tags.end() ? std::string_view() : tag->second;
}

Result<OsmDocument> parse_osm(std::string_view text, std::string file) {
  pugi::xml_document xml;
  const auto root = parse_xml(text, file, {.name = "OSM", .root = "osm"}, xml);
  if (!root) return tl::unexpected(root.error());
  return OsmReader(text, std::move(file)).read(*root);
}

}  // namespace bevloc
