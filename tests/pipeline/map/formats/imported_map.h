// What the importer makes of a text.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/map/formats/map_format.h"

namespace bevloc::test {

/// The map of a text that must be readable.
inline ImportedMap imported(std::string_view text, const std::string& file,
                            const ImportOptions& options = {}) {
  auto map = parse_imported(text, file, options);
  EXPECT_TRUE(map.has_value()) << map.error().message;
  return map.value_or(ImportedMap{});
}

/// The error message, or an empty text if the text is readable.
inline std::string import_error(std::string_view text, const std::string& file,
                                const ImportOptions& options = {}) {
  const auto map = parse_imported(text, file, options);
  return map ? "" : map.error().message;
}

/// The elements of a class, and of an appearance if there is one given.
inline std::vector<MapElement> of(const ImportedMap& imported, ElementClass element_class,
                                  std::optional<Appearance> appearance = {}) {
  std::vector<MapElement> found;
  for (const MapElement& element : imported.map.elements) {
    if (element.element_class == element_class &&
        element.appearance == appearance.value_or(element.appearance)) {
      found.push_back(element);
    }
  }
  return found;
}

}  // namespace bevloc::test
