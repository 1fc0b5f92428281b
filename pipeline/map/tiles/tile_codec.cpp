#include "pipeline/map/tiles/tile_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "common/crc32.h"
#include "common/geodetic.h"
#include "pipeline/map/compact_codec.h"
#include "pipeline/map/map_checksum.h"
#include "pipeline/map/tiles/tile_header.h"
#include "pipeline/map/tiles/tile_piece.h"

namespace bevloc {
namespace {

/// Elements that were found in pieces.
class ElementJoiner {
 public:
  explicit ElementJoiner(size_t count) : count_(count) {}

  void add(const TilePiece& piece, CompactDecoder& decoder) {
    Part part{piece, points_.size()};
    for (size_t i = 0; i < piece.count && !decoder.error(); ++i) {
      points_.push_back(next_point(decoder));
    }
    if (piece.count >= 2) parts_.push_back(part);
  }

  /// Puts the parts of each element together. Fails, and names what was found, if they do not fit.
  Result<std::vector<MapElement>> join() {
    std::vector<MapElement> elements(count_);
    std::ranges::sort(parts_, [](const Part& a, const Part& b) {
      return std::tuple(a.piece.element, a.piece.first, a.begin) <
             std::tuple(b.piece.element, b.piece.first, b.begin);
    });
    for (const Part& part : parts_) {
      MapElement& element = elements[part.piece.element];
      if (element.points.empty()) {
        element.element_class = part.piece.element_class;
        element.appearance = part.piece.appearance;
      }
      const bool fits = part.piece.first <= element.points.size() &&
                        element.element_class == part.piece.element_class &&
                        element.appearance == part.piece.appearance;
      if (!fits) return fail("found pieces of element {} that do not fit", part.piece.element);
      for (size_t i = 0; i < part.piece.count; ++i) {
        const size_t at = part.piece.first + i;
        const Eigen::Vector2d& point = points_[part.begin + i];
        if (at == element.points.size()) element.points.push_back(point);
        if (element.points[at] != point) {
          return fail("found two places of point {} of element {}", at, part.piece.element);
        }
      }
    }
    return elements;
  }

 private:
  struct Part {
    TilePiece piece;
    size_t begin;
  };

  size_t count_;
  std::vector<Eigen::Vector2d> points_;
  std::vector<Part> parts_;
};

/// Reads the elements with fewer than two points, and the lanes.
Status decode_rest(const TileDirectory& directory, HdMap& map) {
  if (crc32(directory.rest()) != directory.rest_crc()) return fail("lanes: found a wrong CRC-32");
  CompactDecoder decoder(directory.rest());
  const size_t count = decoder.count(4);
  for (size_t i = 0; i < count && !decoder.error(); ++i) {
    const uint64_t index = decoder.number_below(map.elements.size(), "an element beyond the last");
    const uint8_t element_class = decoder.byte();
    const uint8_t appearance = decoder.byte();
    std::vector<Eigen::Vector2d> points = decoder.polyline();
    if (decoder.error()) break;
    MapElement& element = map.elements[index];
    const bool fits = element.points.empty() && points.size() < 2 &&
                      element_class < kElementClasses && appearance < kAppearances;
    if (!fits) {
      decoder.reject("an element that no map can have");
      break;
    }
    element = {static_cast<ElementClass>(element_class), static_cast<Appearance>(appearance),
               std::move(points)};
  }
  map.lanes = decode_lanes(decoder);
  if (!decoder.at_end()) decoder.reject("more bytes after the last lane");
  if (decoder.error()) return fail("lanes: {}", *decoder.error());
  if (map.lanes.size() != directory.facts().lanes) return fail("found another number of lanes");
  return {};
}

/// Whether the map has as many elements of each class as the file states.
bool has_elements_of(const TiledMapFacts& facts, const HdMap& map) {
  uint32_t found[kElementClasses] = {};
  for (const MapElement& element : map.elements) {
    ++found[static_cast<size_t>(element.element_class)];
  }
  return std::ranges::equal(found, facts.of_class);
}

/// The size in bytes of the name and the entries together.
uint64_t directory_size(const TileHeader& header) {
  return header.name_size + uint64_t{header.tiles} * kTileEntrySize;
}

/// Checks the header, and that the parts it names lie within the file.
Result<TileHeader> header_of(std::string_view bytes, const std::string& file) {
  if (!is_tiled(bytes) || bytes.size() < kTileHeaderSize) {
    return fail("{}: found {} bytes, wanted a compact map of version {} with at least {}", file,
                bytes.size(), kTiledVersion, kTileHeaderSize);
  }
  const uint32_t header_crc = fixed_at<uint32_t>(bytes, kHeaderCrcOffset);
  if (const uint32_t found = crc32(bytes.substr(0, kHeaderCrcOffset)); found != header_crc) {
    return fail("{}: byte 0: found CRC-32 {:08x} of the header, wanted {:08x} as the file states",
                file, found, header_crc);
  }
  TileHeader header;
  size_t at = kValuesOffset;
  TileHeader::each(header, [&](auto& value) {
    value = fixed_at<std::decay_t<decltype(value)>>(bytes, at);
    at += sizeof(value);
  });
  if (header.file_size != bytes.size()) {
    return fail("{}: found {} bytes, wanted {} as its header states", file, bytes.size(),
                header.file_size);
  }
  const bool fits = directory_size(header) <= bytes.size() - kTileHeaderSize &&
                    header.rest_offset >= kTileHeaderSize + directory_size(header) &&
                    header.rest_offset <= bytes.size() &&
                    header.rest_size == bytes.size() - header.rest_offset &&
                    header.tile_quanta == kTileQuanta;
  if (!fits) {
    return fail("{}: byte {}: found a header whose parts are not within the file", file,
                kValuesOffset);
  }
  return header;
}

}  // namespace

bool is_tiled(std::string_view bytes) {
  return bytes.size() >= kValuesOffset && bytes.starts_with(kMapMagic) &&
         fixed_at<uint16_t>(bytes, kMapMagic.size()) == kTiledVersion;
}

int32_t tile_of(double coordinate_m) {
  constexpr double kLimit = 1e8;
  return static_cast<int32_t>(std::clamp(std::floor(coordinate_m / kTileSize_m), -kLimit, kLimit));
}

Result<TileDirectory> TileDirectory::open(std::string_view bytes, const std::string& file) {
  const Result<TileHeader> header = header_of(bytes, file);
  if (!header) return tl::unexpected(header.error());
  const std::string_view named = bytes.substr(kTileHeaderSize, directory_size(*header));
  if (const uint32_t found = crc32(named); found != header->directory_crc) {
    return fail("{}: byte {}: found CRC-32 {:08x} of the directory, wanted {:08x}", file,
                kTileHeaderSize, found, header->directory_crc);
  }
  TileDirectory directory;
  directory.bytes_ = bytes;
  directory.entries_ = named.substr(header->name_size);
  directory.rest_ = bytes.substr(header->rest_offset);
  directory.rest_crc_ = header->rest_crc;
  TiledMapFacts& facts = directory.facts_;
  facts.name = named.substr(0, header->name_size);
  facts.origin = {std::bit_cast<double>(header->latitude_bits),
                  std::bit_cast<double>(header->longitude_bits)};
  facts.checksum = header->checksum;
  facts.elements = header->elements;
  facts.lanes = header->lanes;
  std::ranges::copy(header->of_class, facts.of_class);
  facts.tiles = header->tiles;
  if (!is_on_earth(facts.origin.latitude_deg, facts.origin.longitude_deg)) {
    return fail("{}: found an origin that is not on earth", file);
  }
  if (Status status = directory.check_entries(*header, file); !status) {
    return tl::unexpected(status.error());
  }
  return directory;
}

Status TileDirectory::check_entries(const TileHeader& header, const std::string& file) const {
  const uint64_t tiles_begin = kTileHeaderSize + directory_size(header);
  const auto fault_of = [&](size_t i) -> const char* {
    const Entry at = entry(i);
    const bool is_inside = at.offset >= tiles_begin && at.offset <= header.rest_offset &&
                           at.size <= header.rest_offset - at.offset;
    if (!is_inside) return "beyond the tiles";
    if (i == 0) return nullptr;
    const Entry before = entry(i - 1);
    if (std::pair(before.row, before.column) >= std::pair(at.row, at.column)) return "out of order";
    return at.offset < before.offset + before.size ? "over the tile before it" : nullptr;
  };
  for (size_t i = 0; i < size(); ++i) {
    const char* fault = fault_of(i);
    if (fault == nullptr) continue;
    return fail("{}: byte {}: found entry {} of the directory {}", file,
                kTileHeaderSize + header.name_size + i * kTileEntrySize, i, fault);
  }
  return {};
}

TileDirectory::Entry TileDirectory::entry(size_t index) const {
  const size_t at = index * kTileEntrySize;
  return {static_cast<int32_t>(fixed_at<uint32_t>(entries_, at)),
          static_cast<int32_t>(fixed_at<uint32_t>(entries_, at + 4)),
          fixed_at<uint64_t>(entries_, at + 8), fixed_at<uint32_t>(entries_, at + 16),
          fixed_at<uint32_t>(entries_, at + 20)};
}

std::optional<size_t> TileDirectory::find(int32_t column, int32_t row) const {
  size_t low = 0;
  size_t high = size();
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    const Entry at = entry(middle);
    if (std::pair(at.row, at.column) < std::pair(row, column)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low == size()) return std::nullopt;
  const Entry found = entry(low);
  return found.row == row && found.column == column ? std::optional(low) : std::nullopt;
}

Result<HdMap> decode_tiles(std::string_view bytes, const std::string& file) {
  const auto directory = TileDirectory::open(bytes, file);
  if (!directory) return tl::unexpected(directory.error());
  const TiledMapFacts& facts = directory->facts();
  // Each element has a piece of at least six bytes, or an entry of at least four in the rest.
  if (facts.elements > bytes.size() / 4) {
    return fail("{}: found {} elements in {} bytes", file, facts.elements, bytes.size());
  }
  ElementJoiner joiner(facts.elements);
  for (size_t i = 0; i < directory->size(); ++i) {
    const TileDirectory::Entry entry = directory->entry(i);
    const std::string_view tile = directory->tile(entry);
    const bool is_good = crc32(tile) == entry.crc &&
                         for_each_piece(tile, entry.column, entry.row, facts.elements,
                                        [&joiner](const TilePiece& piece, CompactDecoder& decoder) {
                                          joiner.add(piece, decoder);
                                        });
    if (!is_good) {
      return fail("{}: byte {}: found a damaged tile (column {}, row {})", file, entry.offset,
                  entry.column, entry.row);
    }
  }
  auto elements = joiner.join();
  if (!elements) return fail("{}: {}", file, elements.error().message);
  HdMap map{facts.name, facts.origin, std::move(*elements), {}};
  if (Status status = decode_rest(*directory, map); !status) {
    return fail("{}: {}, wanted a valid compact map", file, status.error().message);
  }
  if (!has_elements_of(facts, map)) return fail("{}: found other numbers of elements", file);
  if (const uint32_t found = map_checksum(map); found != facts.checksum) {
    return fail("{}: found checksum {:08x}, wanted {:08x} as the file states", file, found,
                facts.checksum);
  }
  return map;
}

}  // namespace bevloc
