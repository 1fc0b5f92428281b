// Reads and writes maps as GeoJSON (RFC 7946).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/formats/map_builder.h"

namespace bevloc {

/// Reads a FeatureCollection of LineString, MultiLineString, Polygon and MultiPolygon features in
/// longitude, latitude and, where there is one, height. The property `class` (or, without it,
/// `type`) gives the kind: the words of class_names.h ("lane divider" or "divider"), or any word
/// that the class table knows; `appearance` is optional. A feature of class "lane" has the
/// centre line, and the properties `left`, `right` (lists of longitude and latitude), `speed_mps`
/// and `successors` (numbers of lanes, in the order of the file), as to_geojson() writes them. With
/// neither list of bounds, "lane" is a kind like any other.
///
/// Fails with file, line and path on what is not GeoJSON, and on positions beyond the earth.
Result<ImportedMap> parse_geojson(std::string_view text, const std::filesystem::path& file,
                                  const ImportOptions& options);

/// Writes all elements, with their heights, and lanes of a map. Fails if the map has no place on
/// earth.
Result<std::string> to_geojson(const ImportedMap& imported);

}  // namespace bevloc
