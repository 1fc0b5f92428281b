#include "firmware/runtime/identity.h"

#include <spdlog/spdlog.h>

#include "common/crc32.h"
#include "common/files.h"
#include "common/version.h"
#include "pipeline/map/map_checksum.h"

namespace bevloc::firmware {
namespace {

uint32_t checksum_of(const Result<std::string>& bytes) {
  return bytes ? crc32(*bytes) : 0U;
}

}  // namespace

can::Identity identity_of(const Config& config, const HdMap& map) {
  return {.program = crc32(version()),
          .configuration = checksum_of(config.kept_files.bytes_of(config.file)),
          .model = checksum_of(read_file(config.model_file)),
          .rig = checksum_of(config.kept_files.bytes_of(config.rig_file)),
          .map = map_checksum(map)};
}

uint16_t map_id_of(const HdMap& map) {
  const uint32_t checksum = map_checksum(map);
  return static_cast<uint16_t>(checksum ^ (checksum >> 16U));
}

void log_identity(const can::Identity& identity, const HdMap& map, std::string_view model_name) {
  spdlog::info(
      "bevloc {}: model {}, map {} (id {:#06x}, {} elements); CRC-32: program {:08x}, "
      "configuration "
      "{:08x}, model {:08x}, rig {:08x}, map {:08x}",
      version(), model_name, map.name, map_id_of(map), map.elements.size(), identity.program,
      identity.configuration, identity.model, identity.rig, identity.map);
}

}  // namespace bevloc::firmware
