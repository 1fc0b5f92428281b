// The words for classes and appearances in files and reports.
#pragma once

#include <optional>
#include <string_view>

#include "pipeline/map/hd_map.h"

namespace bevloc {

/// "lane divider", "pedestrian crossing" or "road boundary".
std::string_view name_of(ElementClass element_class);
/// Such as "dashed", "kerb" or "unknown".
std::string_view name_of(Appearance appearance);

/// The inverse; a class also goes by its short name (divider, crossing, boundary). Nothing for any
/// other word.
std::optional<ElementClass> class_named(std::string_view name);
std::optional<Appearance> appearance_named(std::string_view name);

/// Whether elements of this class can look like this. All can be unknown.
bool fits(Appearance appearance, ElementClass element_class);

}  // namespace bevloc
