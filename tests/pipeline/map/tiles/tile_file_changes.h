// Changes compact map files of version 2 and states the right sizes and checksums again, so that
// the checks behind the checksums see the change.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "common/crc32.h"
#include "pipeline/map/compact_codec.h"
#include "pipeline/map/tiles/tile_header.h"

namespace bevloc::test {

/// Places of the values in an entry of the directory, in bytes.
inline constexpr size_t kEntryColumn = 0;
inline constexpr size_t kEntryRow = 4;
inline constexpr size_t kEntryOffset = 8;
inline constexpr size_t kEntrySize = 16;
inline constexpr size_t kEntryCrc = 20;

/// Overwrites a number of the file.
template <typename T>
void put_fixed(std::string& bytes, size_t offset, T value) {
  std::string number;
  append_fixed(number, value);
  bytes.replace(offset, sizeof(T), number);
}

/// Reads the values of the header. The file must have at least kTileHeaderSize bytes.
inline TileHeader tile_header_of(std::string_view bytes) {
  TileHeader header;
  size_t at = kValuesOffset;
  TileHeader::each(header, [&](auto& value) {
    value = fixed_at<std::decay_t<decltype(value)>>(bytes, at);
    at += sizeof(value);
  });
  return header;
}

/// Lets change(header) change the values of the header. The file must have at least kTileHeaderSize
/// bytes.
template <typename Change>
void change_tile_header(std::string& bytes, Change change) {
  TileHeader header = tile_header_of(bytes);
  change(header);
  size_t at = kValuesOffset;
  TileHeader::each(header, [&](auto value) {
    put_fixed(bytes, at, value);
    at += sizeof(value);
  });
}

/// The place of an entry of the directory.
inline size_t tile_entry_place(const TileHeader& header, size_t index) {
  return kTileHeaderSize + header.name_size + index * kTileEntrySize;
}

/// States the size of the file, and that the rest ends with it.
inline void state_tile_sizes(std::string& bytes) {
  change_tile_header(bytes, [&bytes](TileHeader& header) {
    header.file_size = bytes.size();
    header.rest_size = header.rest_offset < bytes.size() ? bytes.size() - header.rest_offset : 0;
  });
}

/// States the checksums of the tiles, the rest, the directory and the header. Leaves out the parts
/// that are not within the file. The file must have at least kTileHeaderSize bytes.
inline void state_tile_checksums(std::string& bytes) {
  const std::string_view view(bytes);  // stays valid, because the size does not change
  change_tile_header(bytes, [&](TileHeader& header) {
    if (header.rest_offset <= view.size()) header.rest_crc = crc32(view.substr(header.rest_offset));
    const uint64_t directory_end =
        kTileHeaderSize + uint64_t{header.name_size} + uint64_t{header.tiles} * kTileEntrySize;
    if (directory_end > view.size()) return;
    for (size_t i = 0; i < header.tiles; ++i) {
      const size_t place = tile_entry_place(header, i);
      const auto offset = fixed_at<uint64_t>(view, place + kEntryOffset);
      const auto size = fixed_at<uint32_t>(view, place + kEntrySize);
      if (offset > view.size() || size > view.size() - offset) continue;
      put_fixed(bytes, place + kEntryCrc, crc32(view.substr(offset, size)));
    }
    header.directory_crc = crc32(view.substr(kTileHeaderSize, directory_end - kTileHeaderSize));
  });
  put_fixed(bytes, kHeaderCrcOffset, crc32(view.substr(0, kHeaderCrcOffset)));
}

}  // namespace bevloc::test
