#include "pipeline/map/lanelet_tags.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "common/number_text.h"
#include "pipeline/map/speed_unit.h"

namespace bevloc {
namespace {

bool is_yes(std::string_view value) {
  return value == "yes" || value == "true" || value == "1";
}

std::string kind_of(std::string_view element, const OsmTags& tags) {
  const std::string_view type = tag_value(tags, "type");
  const std::string_view subtype = tag_value(tags, "subtype");
  std::string kind(element);
  kind.append(" ").append(type.empty() ? "without type" : type);
  if (!subtype.empty()) kind.append(" ").append(subtype);
  return kind;
}

}  // namespace

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

std::optional<double> speed_mps(std::string_view text) {
  text = trimmed_number(text);
  double value = 0.0;
  const auto number = std::from_chars(text.data(), text.data() + text.size(), value);
  if (number.ec != std::errc() || !(value > 0.0 && value < 1000.0)) return std::nullopt;
  std::string_view unit = text.substr(static_cast<size_t>(number.ptr - text.data()));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  if (unit.empty() || unit == "km/h" || unit == "kmh" || unit == "kph") return value / kKmh_per_mps;
  if (unit == "mph") return value * kMps_per_mph;
  if (unit == "m/s") return value;
  return std::nullopt;
}

bool is_no(std::string_view value) {
  return value == "no" || value == "false" || value == "0";
}

std::string way_kind(const OsmTags& tags) {
  return kind_of("way", tags);
}

std::string relation_kind(const OsmTags& tags) {
  return kind_of("relation", tags);
}

}  // namespace bevloc
