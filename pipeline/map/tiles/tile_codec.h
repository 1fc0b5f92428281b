// Compact map files of version 2 (.bvm): elements in tiles, so that a map need not be read as a
// whole.
//
// All numbers are little-endian; varints and differences as in map_binary.h. The file:
//
//     header, kTileHeaderSize bytes (tile_header.h)
//     name
//     directory: one entry per tile, sorted by row, then by column: column i32, row i32, offset in
//                the file u64, size u32, CRC-32 of the tile u32
//     tiles: each a sequence of pieces
//     rest: elements with fewer than two points, then the lanes as in version 1
//
// Tile (c, r) covers x from c to c + 1 times kTileSize_m, and y likewise from r. It contains every
// segment that touches it, so a query reads only the tiles under its box. A piece consists of the
// number of the element, as a difference from the piece before; the number of its first point;
// class + 4 * appearance (one byte); the count of points; and the points as differences in
// millimetres, of which the first counts from the tile's corner. Crossings are always whole.
//
// The header has checksums of itself, of name and directory, and of the rest; each tile has its
// own.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

inline constexpr uint16_t kTiledVersion = 2;
inline constexpr double kTileSize_m = 128.0;
inline constexpr size_t kTileHeaderSize = 120;
inline constexpr size_t kTileEntrySize = 24;

/// Encodes a map for which check_map() holds.
std::string encode_tiles(const HdMap& map);

/// Whether the bytes begin as a file of version 2.
bool is_tiled(std::string_view bytes);

/// Decodes a whole file. Fails, with `file` and the byte in the message, unless encode_tiles()
/// wrote the bytes.
Result<HdMap> decode_tiles(std::string_view bytes, const std::string& file);

/// The facts about a map that its file states outside of the tiles.
struct TiledMapFacts {
  std::string name;
  GeoOrigin origin;
  uint32_t checksum = 0;  ///< map_checksum() of the whole map
  uint32_t elements = 0;
  uint32_t lanes = 0;
  uint32_t of_class[kElementClasses] = {};  ///< elements of each class
  uint32_t tiles = 0;
};

struct TileHeader;

/// The checked header and directory of a file. The bytes must outlive it. Immutable, and so
/// thread-safe.
class TileDirectory {
 public:
  struct Entry {
    int32_t column;
    int32_t row;
    uint64_t offset;
    uint32_t size;
    uint32_t crc;
  };

  /// Reads header, name and directory only. Fails, with `file` and the byte in the message, on
  /// offsets beyond the file and on wrong checksums.
  static Result<TileDirectory> open(std::string_view bytes, const std::string& file);

  const TiledMapFacts& facts() const { return facts_; }
  size_t size() const { return facts_.tiles; }
  Entry entry(size_t index) const;
  /// The index of a tile, or nothing if the map is empty there.
  std::optional<size_t> find(int32_t column, int32_t row) const;
  std::string_view tile(const Entry& entry) const {
    return bytes_.substr(entry.offset, entry.size);
  }
  /// The elements without segments, and the lanes. The caller compares their CRC-32 with
  /// rest_crc().
  std::string_view rest() const { return rest_; }
  uint32_t rest_crc() const { return rest_crc_; }

 private:
  Status check_entries(const TileHeader& header, const std::string& file) const;

  std::string_view bytes_;
  std::string_view entries_;
  std::string_view rest_;
  uint32_t rest_crc_ = 0;
  TiledMapFacts facts_;
};

/// The column or row of a coordinate.
int32_t tile_of(double coordinate_m);

}  // namespace bevloc
