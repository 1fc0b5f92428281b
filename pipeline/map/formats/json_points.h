// Reads numbers and points out of JSON maps.
#pragma once

#include <string>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/formats/json_text.h"
#include "pipeline/map/formats/map_builder.h"

namespace bevloc {

using JsonPath = nlohmann::json::json_pointer;

/// An id of a map, which is a number or a text. Returns "" for anything else.
std::string id_text(const nlohmann::json& value);

/// The member of an object, or a null value if there is none.
const nlohmann::json& member(const nlohmann::json& object, std::string_view key);

/// The text of a member, or "" if it is missing or no text.
std::string text_member(const nlohmann::json& object, std::string_view key);

/// Reads [{"x": .., "y": .., "z": ..}, ...] with at least `least` points; z may be missing.
Result<Line3> xyz_points(const JsonText& document, const nlohmann::json& points,
                         const JsonPath& path, size_t least);

}  // namespace bevloc
