#include "pipeline/map/map_checksum.h"

#include <bit>
#include <cmath>
#include <string>

#include "common/crc32.h"
#include "pipeline/map/map_binary.h"

namespace bevloc {
namespace {

void append_bytes(std::string& bytes, uint64_t value) {
  for (unsigned shift = 0; shift < 64; shift += 8) {
    bytes.push_back(static_cast<char>((value >> shift) & 0xFF));
  }
}

}  // namespace

uint32_t map_checksum(const HdMap& map) {
  std::string bytes;
  append_bytes(bytes, std::bit_cast<uint64_t>(map.origin.latitude_deg));
  append_bytes(bytes, std::bit_cast<uint64_t>(map.origin.longitude_deg));
  for (const MapElement& element : map.elements) {
    append_bytes(bytes, static_cast<uint64_t>(element.element_class));
    append_bytes(bytes, element.points.size());
    for (const Eigen::Vector2d& point : element.points) {
      for (const double coordinate_m : {point.x(), point.y()}) {
        append_bytes(bytes, static_cast<uint64_t>(std::llround(coordinate_m / kMapQuantumM)));
      }
    }
  }
  return crc32(bytes);
}

}  // namespace bevloc
