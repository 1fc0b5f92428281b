// The header of a compact map file of version 2.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/map/map_binary.h"
#include "pipeline/map/tiles/tile_codec.h"

namespace bevloc {

inline constexpr auto kTileQuanta = static_cast<int64_t>(kTileSize_m / kMapQuantumM);

/// The fixed part of a file, in this order.
struct TileHeader {
  uint64_t file_size = 0;
  uint32_t checksum = 0;
  uint32_t elements = 0;
  uint32_t lanes = 0;
  uint32_t of_class[kElementClasses] = {};
  uint32_t tiles = 0;
  uint32_t tile_quanta = 0;
  uint32_t name_size = 0;
  uint64_t latitude_bits = 0;
  uint64_t longitude_bits = 0;
  uint64_t rest_offset = 0;
  uint64_t rest_size = 0;
  uint32_t rest_crc = 0;
  uint32_t directory_crc = 0;  ///< CRC-32 of name and directory

  /// Calls visit(value) for each value, in the order of the file.
  template <typename Header, typename Visit>
  static void each(Header& header, Visit visit) {
    visit(header.file_size);
    visit(header.checksum);
    visit(header.elements);
    visit(header.lanes);
    for (auto& count : header.of_class) visit(count);
    visit(header.tiles);
    visit(header.tile_quanta);
    visit(header.name_size);
    visit(header.latitude_bits);
    visit(header.longitude_bits);
    visit(header.rest_offset);
    visit(header.rest_size);
    visit(header.rest_crc);
    visit(header.directory_crc);
  }
};

/// Magic, version and two unused bytes precede the values. The checksum of the header is at its
/// end.
inline constexpr size_t kValuesOffset = kMapMagic.size() + sizeof(uint16_t) + sizeof(uint16_t);
inline constexpr size_t kHeaderCrcOffset = kTileHeaderSize - sizeof(uint32_t);

}  // namespace bevloc
