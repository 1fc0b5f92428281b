// The words for classes and appearances in files and reports.
#pragma once

#include <optional>
#include <string_view>

#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Returns "lane divider", "pedestrian crossing" or "road boundary".
std::string_view name_of(ElementClass element_class);
/// Returns a word such as "dashed", "kerb" or "unknown".
std::string_view name_of(Appearance appearance);

/// The inverse of name_of(). A class may also have its short name (divider, crossing, boundary).
/// Returns nothing for any other word.
std::optional<ElementClass> class_named(std::string_view name);
std::optional<Appearance> appearance_named(std::string_view name);

/// Whether elements of this class can look like this. Elements of any class can be kUnknown.
bool fits(Appearance appearance, ElementClass element_class);

}  // namespace bevloc
