// The map formats that bevloc reads: one entry for each, found by content, then by extension.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/formats/map_builder.h"

namespace bevloc {

struct MapFormat {
  std::string_view name;       ///< "OpenDRIVE"
  std::string_view extension;  ///< ".xodr"
  /// Whether the bytes can only be of this format.
  bool (*recognizes)(std::string_view bytes);
  /// `file` gives the name of the map and the name in messages.
  Result<ImportedMap> (*read)(std::string_view bytes, const std::filesystem::path& file,
                              const ImportOptions& options);
};

/// Fails on bytes and an extension that no format knows, and names all formats.
Result<const MapFormat*> find_map_format(std::string_view bytes, const std::filesystem::path& file);

/// Reads a map of any format with its report. Fails also on a map in which nothing can be localized
/// (map_check.h).
Result<ImportedMap> import_map(const std::filesystem::path& file, const ImportOptions& options);

/// Does the same for the bytes of a file in memory.
Result<ImportedMap> parse_imported(std::string_view bytes, const std::filesystem::path& file,
                                   const ImportOptions& options);

}  // namespace bevloc
