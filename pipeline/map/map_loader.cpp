#include "pipeline/map/map_loader.h"

#include "common/files.h"
#include "pipeline/map/lanelet2_reader.h"
#include "pipeline/map/map_binary.h"

namespace bevloc {

Result<HdMap> load_map(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  if (bytes->starts_with(kMapMagic)) return decode_map(*bytes, path.string());
  if (path.extension() == ".osm") return parse_lanelet2(*bytes, path);
  return fail(
      "{}: found neither the magic number \"{}\" nor the extension .osm, "
      "wanted a compact map or a Lanelet2 map",
      path.string(), kMapMagic);
}

}  // namespace bevloc
