// The meaning of the tags of Lanelet2 (LinestringTagging.md and LaneletAndAreaTagging.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pipeline/map/hd_map.h"
#include "pipeline/map/osm_document.h"

namespace bevloc {

enum class LaneletKind : uint8_t { kVehicles, kCrosswalk, kOther };

/// Explicit participant tags override the participants that the subtype implies.
LaneletKind kind_of(const OsmTags& tags);

/// Returns nothing if ways of this type are no road boundaries.
std::optional<Appearance> boundary_appearance(std::string_view type);

/// Returns kUnknown for an unknown subtype.
Appearance divider_appearance(std::string_view subtype);

/// Parses a speed tag with the unit km/h (kmh, kph), mph or m/s; without a unit it is km/h.
std::optional<double> speed_mps(std::string_view text);

/// The name of a kind of way in a report, such as "way line_thin dashed".
std::string way_kind(const OsmTags& tags);

/// The name of a kind of relation in a report, such as "relation regulatory_element speed_limit".
std::string relation_kind(const OsmTags& tags);

/// Whether a tag says no.
bool is_no(std::string_view value);

}  // namespace bevloc
