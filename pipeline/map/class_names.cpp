#include "pipeline/map/class_names.h"

#include <algorithm>
#include <array>
#include <utility>

namespace bevloc {
namespace {

struct ClassName {
  ElementClass element_class;
  std::string_view name;
  std::string_view short_name;
};

constexpr std::array kClassNames{
    ClassName{ElementClass::kLaneDivider, "lane divider", "divider"},
    ClassName{ElementClass::kPedestrianCrossing, "pedestrian crossing", "crossing"},
    ClassName{ElementClass::kRoadBoundary, "road boundary", "boundary"},
};

/// The names in the order of the enumerators.
constexpr std::array<std::string_view, kAppearances> kAppearanceNames{
    "unknown",   "solid",   "dashed",     "double solid", "zebra", "ladder", "kerb",
    "road edge", "barrier", "guard rail", "wall",         "fence", "hedge"};

}  // namespace

std::string_view name_of(ElementClass element_class) {
  return kClassNames[static_cast<size_t>(element_class)].name;
}

std::string_view name_of(Appearance appearance) {
  return kAppearanceNames[static_cast<size_t>(appearance)];
}

std::optional<ElementClass> class_named(std::string_view name) {
  for (const ClassName& entry : kClassNames) {
    if (name == entry.name || name == entry.short_name) return entry.element_class;
  }
  return std::nullopt;
}

std::optional<Appearance> appearance_named(std::string_view name) {
  const auto found = std::ranges::find(kAppearanceNames, name);
  if (found == kAppearanceNames.end()) return std::nullopt;
  return static_cast<Appearance>(found - kAppearanceNames.begin());
}

bool fits(Appearance appearance, ElementClass element_class) {
  if (appearance == Appearance::kUnknown) return true;
  if (appearance <= Appearance::kDoubleSolid) return element_class == ElementClass::kLaneDivider;
  if (appearance <= Appearance::kLadder) return element_class == ElementClass::kPedestrianCrossing;
  return element_class == ElementClass::kRoadBoundary;
}

}  // namespace bevloc
