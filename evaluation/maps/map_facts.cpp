#include "evaluation/maps/map_facts.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "pipeline/map/class_names.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/line_neighbours.h"
#include "pipeline/map/map_checksum.h"
#include "pipeline/map/map_points.h"
#include "pipeline/map/map_summary.h"

namespace bevloc::evaluation {
namespace {

using Points = std::vector<Eigen::Vector2d>;

/// Lines of one class this close, along nearly all of the line, are the same line twice.
constexpr double kSameLine_m = 0.05;
constexpr double kSameShare = 0.95;
constexpr double kShortLine_m = 0.1;
/// A BEV reaches this far to the side.
constexpr double kReach_m = 15.0;
/// This share of the lanes may have no lines beside them.
constexpr double kMostBare = 0.02;

/// A list of numbers of elements. Of many numbers it has only the first ones.
std::string list_of(const std::vector<size_t>& numbers) {
  constexpr size_t kMost = 5;
  std::string text;
  for (size_t i = 0; i < std::min(numbers.size(), kMost); ++i) {
    text += fmt::format("{}{}", i > 0 ? ", " : "", numbers[i]);
  }
  return text + (numbers.size() > kMost ? " and more" : "");
}

/// "1 element TEXT_OF_ONE: 4" or "2 elements TEXT_OF_MANY: 4, 7".
std::string fault_of(const std::vector<size_t>& elements, std::string_view text_of_one,
                     std::string_view text_of_many) {
  const bool is_one = elements.size() == 1;
  return fmt::format("{} element{} {}: {}", elements.size(), is_one ? "" : "s",
                     is_one ? text_of_one : text_of_many, list_of(elements));
}

/// Finds elements that lie on others of their class. Of two that lie on each other, it names the
/// shorter one. `lines` are all elements of the map.
void find_double_lines(const HdMap& map, const LineNeighbours& lines,
                       std::vector<std::string>& faults) {
  std::vector<size_t> shortest_first(map.elements.size());
  std::iota(shortest_first.rbegin(), shortest_first.rend(), size_t{0});
  std::ranges::stable_sort(shortest_first, {},
                           [&](size_t i) { return polyline_length(map.elements[i].points); });
  std::vector<bool> is_doubled(map.elements.size(), false);
  for (const size_t i : shortest_first) {
    const auto counts = [&](int64_t id) {
      const auto other = static_cast<size_t>(id);
      return other != i && !is_doubled[other] &&
             map.elements[other].element_class == map.elements[i].element_class;
    };
    is_doubled[i] = lines.share_beside(map.elements[i].points, kSameLine_m, counts) >= kSameShare;
  }
  std::vector<size_t> doubled;
  for (size_t i = 0; i < is_doubled.size(); ++i) {
    if (is_doubled[i]) doubled.push_back(i);
  }
  if (doubled.empty()) return;
  faults.push_back(
      fault_of(doubled, "lies on another one of its class", "lie on another one of their class"));
}

void find_bare_lanes(const HdMap& map, const LineNeighbours& lines,
                     std::vector<std::string>& faults) {
  double bare_m = 0.0, all_m = 0.0;
  std::vector<size_t> worst;
  for (size_t i = 0; i < map.lanes.size(); ++i) {
    const Points& center = map.lanes[i].centerline;
    const double length_m = polyline_length(center);
    const double bare =
        length_m > 0.0 ? 1.0 - lines.share_beside(center, kReach_m, [](int64_t) { return true; })
                       : 0.0;
    if (bare > 0.5) worst.push_back(i);
    bare_m += bare * length_m;
    all_m += length_m;
  }
  if (bare_m <= kMostBare * all_m) return;
  faults.push_back(fmt::format("{:.0f} of {:.0f} m of lanes have no line within {:g} m{}{}", bare_m,
                               all_m, kReach_m, worst.empty() ? "" : ": lanes ", list_of(worst)));
}

}  // namespace

MapFacts facts_of(const HdMap& map) {
  MapFacts facts;
  facts.origin = map.origin;
  facts.lanes = map.lanes.size();
  facts.checksum = map_checksum(map);
  if (const Eigen::AlignedBox2d bounds = bounds_of(map); !bounds.isEmpty()) {
    facts.low = bounds.min();
    facts.high = bounds.max();
  }
  for (const MapElement& element : map.elements) {
    auto& of_class = facts.classes[static_cast<size_t>(element.element_class)];
    ++of_class.elements;
    of_class.points += element.points.size();
    of_class.length_m += length_of(element);
  }
  for (const Lane& lane : map.lanes) facts.lanes_m += polyline_length(lane.centerline);
  return facts;
}

std::string text_of(const GeoOrigin& origin, int decimals) {
  if (!is_known(origin)) return "unknown";
  return fmt::format("{:.{}f}, {:.{}f}", origin.latitude_deg, decimals, origin.longitude_deg,
                     decimals);
}

std::string text_of(const MapFacts& facts) {
  std::string text = fmt::format("{:<22} {:>8} {:>8} {:>11}\n", "", "elements", "points", "length");
  for (size_t c = 0; c < kElementClasses; ++c) {
    const auto& of_class = facts.classes[c];
    text += fmt::format("{:<22} {:8} {:8} {:9.1f} m\n", name_of(static_cast<ElementClass>(c)),
                        of_class.elements, of_class.points, of_class.length_m);
  }
  text += fmt::format("{:<22} {:8} {:8} {:9.1f} m\n", "lane", facts.lanes, "", facts.lanes_m);
  text +=
      fmt::format("origin {}; {:.0f} m x {:.0f} m; checksum {:08x}\n", text_of(facts.origin, 7),
                  facts.high.x() - facts.low.x(), facts.high.y() - facts.low.y(), facts.checksum);
  return text;
}

nlohmann::json json_of(const MapFacts& facts) {
  nlohmann::json classes;
  for (size_t c = 0; c < kElementClasses; ++c) {
    const auto& of_class = facts.classes[c];
    classes[std::string(name_of(static_cast<ElementClass>(c)))] = {{"elements", of_class.elements},
                                                                   {"points", of_class.points},
                                                                   {"length_m", of_class.length_m}};
  }
  return {{"classes", classes},
          {"lanes", facts.lanes},
          {"lanes_m", facts.lanes_m},
          {"latitude_deg", facts.origin.latitude_deg},
          {"longitude_deg", facts.origin.longitude_deg},
          {"low_m", {facts.low.x(), facts.low.y()}},
          {"high_m", {facts.high.x(), facts.high.y()}},
          {"checksum", fmt::format("{:08x}", facts.checksum)}};
}

nlohmann::json json_of(const ImportedMap& imported) {
  nlohmann::json rows = nlohmann::json::array();
  for (const ImportRow& row : imported.report.rows()) {
    nlohmann::json entry{{"kind", row.kind},         {"taken", row.meaning.has_value()},
                         {"why", row.why},           {"count", row.count},
                         {"length_m", row.length_m}, {"examples", row.examples}};
    if (row.meaning) {
      entry["class"] = name_of(row.meaning->element_class);
      entry["appearance"] = name_of(row.meaning->appearance);
    }
    rows.push_back(std::move(entry));
  }
  return {{"rows", rows},
          {"remarks", imported.report.remarks()},
          {"left_out", imported.map.left_out},
          {"map", json_of(facts_of(imported.map))}};
}

std::vector<std::string> faults_of(const HdMap& map) {
  std::vector<std::string> faults = warnings_of(map);
  std::vector<size_t> short_ones;
  for (size_t i = 0; i < map.elements.size(); ++i) {
    if (length_of(map.elements[i]) < kShortLine_m) short_ones.push_back(i);
  }
  if (!short_ones.empty()) {
    const std::string shorter = fmt::format("shorter than {:g} m", kShortLine_m);
    faults.push_back(fault_of(short_ones, "is " + shorter, "are " + shorter));
  }
  LineNeighbours lines;
  for (size_t i = 0; i < map.elements.size(); ++i) {
    lines.add(static_cast<int64_t>(i), map.elements[i].points);
  }
  find_double_lines(map, lines, faults);
  find_bare_lanes(map, lines, faults);
  return faults;
}

}  // namespace bevloc::evaluation
