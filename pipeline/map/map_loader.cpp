#include "pipeline/map/map_loader.h"

#include <utility>

#include "pipeline/map/formats/map_format.h"

namespace bevloc {
namespace {

Result<HdMap> map_of(Result<ImportedMap> imported) {
  if (!imported) return tl::unexpected(imported.error());
  return std::move(imported->map);
}

}  // namespace

Result<HdMap> load_map(const std::filesystem::path& path) {
  return map_of(import_map(path, {}));
}

Result<HdMap> parse_map(std::string_view bytes, const std::filesystem::path& path) {
  return map_of(parse_imported(bytes, path, {}));
}

}  // namespace bevloc
