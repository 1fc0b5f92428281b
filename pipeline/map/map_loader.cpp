#include "pipeline/map/map_loader.h"

#include <utility>

#include "pipeline/map/formats/map_format.h"

namespace bevloc {

Result<HdMap> load_map(const std::filesystem::path& path) {
  Result<ImportedMap> imported = import_map(path, {});
  if (!imported) return tl::unexpected(imported.error());
  return std::move(imported->map);
}

}  // namespace bevloc
