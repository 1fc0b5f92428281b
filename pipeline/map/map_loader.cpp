#include "pipeline/map/map_loader.h"

#include "common/files.h"
#include "pipeline/map/lanelet2_reader.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/map_check.h"

namespace bevloc {

Result<HdMap> load_map(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_map(*bytes, path);
}

Result<HdMap> parse_map(std::string_view bytes, const std::filesystem::path& path) {
  const auto checked = [&path](Result<HdMap> map) -> Result<HdMap> {
    if (!map) return map;
    if (const Status status = check_map(*map, path.string()); !status) {
      return tl::unexpected(status.error());
    }
    return map;
  };
  if (bytes.starts_with(kMapMagic)) return checked(decode_map(bytes, path.string()));
  if (path.extension() == ".osm") return checked(parse_lanelet2(bytes, path));
  return fail(
      "{}: found neither the magic number \"{}\" nor the extension .osm, "
      "wanted a compact map or a Lanelet2 map",
      path.string(), kMapMagic);
}

}  // namespace bevloc
