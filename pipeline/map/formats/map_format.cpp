#include "pipeline/map/formats/map_format.h"

#include <algorithm>
#include <array>
#include <string>

#include "common/files.h"
#include "pipeline/map/formats/argoverse2.h"
#include "pipeline/map/formats/geojson.h"
#include "pipeline/map/formats/nuscenes.h"
#include "pipeline/map/formats/opendrive/opendrive_reader.h"
#include "pipeline/map/lanelet2_reader.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/map_check.h"

namespace bevloc {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool has(std::string_view bytes, std::string_view part) {
  return bytes.find(part) != std::string_view::npos;
}

/// The text without the byte order mark and the white space at its beginning.
std::string_view without_lead(std::string_view bytes) {
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  const size_t first = bytes.find_first_not_of(" \t\r\n");
  return first == std::string_view::npos ? std::string_view() : bytes.substr(first);
}

bool is_json(std::string_view bytes) {
  return without_lead(bytes).starts_with('{');
}

/// Whether the outermost XML element has this name. Comments and declarations before it, which may
/// contain anything, do not count.
bool is_xml_of(std::string_view bytes, std::string_view element) {
  for (std::string_view rest = without_lead(bytes); rest.starts_with('<');
       rest = without_lead(rest)) {
    const bool is_declaration = rest.starts_with("<?") || rest.starts_with("<!");
    if (!is_declaration) return rest.substr(1).starts_with(element);
    const std::string_view end = rest.starts_with("<!--") ? "-->" : ">";
    const size_t at = rest.find(end);
    if (at == std::string_view::npos) return false;
    rest.remove_prefix(at + end.size());
  }
  return false;
}

Result<ImportedMap> read_compact(std::string_view bytes, const std::filesystem::path& file,
                                 const ImportOptions& options) {
  // The import may have shifted the coordinates, so that their zero is not that of the original.
  if (options.classes != nullptr || options.origin) {
    return fail(
        "{}: found a class table or an origin for a compact map, wanted neither; import the "
        "original file again with them",
        file.string());
  }
  Result<HdMap> map = decode_map(bytes, file.string());
  if (!map) {
    return fail(
        "{}; the file is damaged or of another version: make it again with `bevloc_convert_map`",
        map.error().message);
  }
  return ImportedMap{std::move(*map), {}};
}

constexpr std::array kFormats{
    MapFormat{"compact", ".bvm",
              [](std::string_view bytes) { return bytes.starts_with(kMapMagic); }, read_compact},
    MapFormat{"Lanelet2", ".osm", [](std::string_view bytes) { return is_xml_of(bytes, "osm"); },
              parse_lanelet2},
    MapFormat{"OpenDRIVE", ".xodr",
              [](std::string_view bytes) { return is_xml_of(bytes, "OpenDRIVE"); },
              parse_opendrive},
    MapFormat{"GeoJSON", ".geojson",
              [](std::string_view bytes) {
                return is_json(bytes) && has(bytes, "\"FeatureCollection\"");
              },
              parse_geojson},
    MapFormat{
        "Argoverse 2", ".json",
        [](std::string_view bytes) { return is_json(bytes) && has(bytes, "\"lane_segments\""); },
        parse_argoverse2},
    MapFormat{"nuScenes map expansion", ".json",
              [](std::string_view bytes) {
                return is_json(bytes) && has(bytes, "\"drivable_area\"") && has(bytes, "\"node\"");
              },
              parse_nuscenes},
};

}  // namespace

Result<const MapFormat*> find_map_format(std::string_view bytes,
                                         const std::filesystem::path& file) {
  const auto by_content = std::ranges::find_if(
      kFormats, [bytes](const MapFormat& format) { return format.recognizes(bytes); });
  if (by_content != kFormats.end()) return &*by_content;
  const std::string extension = file.extension().string();
  const auto by_name = std::ranges::find(kFormats, extension, &MapFormat::extension);
  if (by_name != kFormats.end() && extension != ".json" && extension != ".bvm") return &*by_name;
  std::string names;
  for (const MapFormat& format : kFormats) {
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", format.name, format.extension);
  }
  return fail("{}: found {} bytes that no map format begins with, wanted one of {}", file.string(),
              bytes.size(), names);
}

Result<ImportedMap> import_map(const std::filesystem::path& file, const ImportOptions& options) {
  const Result<std::string> bytes = read_file(file);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_imported(*bytes, file, options);
}

Result<ImportedMap> parse_imported(std::string_view bytes, const std::filesystem::path& file,
                                   const ImportOptions& options) {
  const auto format = find_map_format(bytes, file);
  if (!format) return tl::unexpected(format.error());
  Result<ImportedMap> imported = (*format)->read(bytes, file, options);
  if (!imported) return imported;
  if (const Status status = check_map(imported->map, file.string()); !status) {
    return tl::unexpected(status.error());
  }
  return imported;
}

}  // namespace bevloc
