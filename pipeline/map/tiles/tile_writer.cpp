// Writes compact map files of version 2.
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include "common/crc32.h"
#include "pipeline/map/compact_codec.h"
#include "pipeline/map/map_checksum.h"
#include "pipeline/map/tiles/tile_header.h"

namespace bevloc {
namespace {

int64_t quanta_of(double coordinate_m) {
  return std::llround(coordinate_m / kMapQuantumM);
}

int32_t tile_of_quanta(int64_t quanta) {
  const int64_t tile = quanta / kTileQuanta;
  return static_cast<int32_t>(quanta % kTileQuanta < 0 ? tile - 1 : tile);
}

struct QuantisedPoint {
  int64_t x;
  int64_t y;
};

std::vector<QuantisedPoint> quantised(const std::vector<Eigen::Vector2d>& points) {
  std::vector<QuantisedPoint> result;
  for (const Eigen::Vector2d& point : points) {
    result.push_back({quanta_of(point.x()), quanta_of(point.y())});
  }
  return result;
}

/// Calls visit(row, column) for each tile that a segment touches. Tiles that it only comes close to
/// (to within 1 mm) may be among them.
template <typename Visit>
void for_each_tile(const QuantisedPoint& a, const QuantisedPoint& b, Visit visit) {
  const int32_t first = tile_of_quanta(std::min(a.x, b.x));
  const int32_t last = tile_of_quanta(std::max(a.x, b.x));
  for (int32_t column = first; column <= last; ++column) {
    double low = static_cast<double>(std::min(a.y, b.y));
    double high = static_cast<double>(std::max(a.y, b.y));
    if (first != last) {
      const double slope = static_cast<double>(b.y - a.y) / static_cast<double>(b.x - a.x);
      const auto at = [&](int64_t x) {
        const auto clamped = std::clamp(x, std::min(a.x, b.x), std::max(a.x, b.x));
        return static_cast<double>(a.y) + slope * static_cast<double>(clamped - a.x);
      };
      const double enter = at(column * kTileQuanta);
      const double leave = at((column + int64_t{1}) * kTileQuanta);
      low = std::min(enter, leave);
      high = std::max(enter, leave);
    }
    const int32_t top = tile_of_quanta(static_cast<int64_t>(std::floor(low)) - 1);
    const int32_t bottom = tile_of_quanta(static_cast<int64_t>(std::ceil(high)) + 1);
    for (int32_t row = top; row <= bottom; ++row) visit(row, column);
  }
}

/// Points first to last of an element in one tile.
struct Run {
  uint32_t element;
  uint32_t first;
  uint32_t last;
};
using Runs = std::map<std::pair<int32_t, int32_t>, std::vector<Run>>;  ///< runs by row and column

Runs runs_of(const HdMap& map, const std::vector<std::vector<QuantisedPoint>>& elements) {
  Runs runs;
  for (uint32_t e = 0; e < elements.size(); ++e) {
    const auto& points = elements[e];
    const auto count = static_cast<uint32_t>(points.size());
    const bool is_whole = is_ring(map.elements[e].element_class);
    for (uint32_t i = 0; i < segment_count(map.elements[e]); ++i) {
      for_each_tile(points[i], points[(i + 1) % count], [&](int32_t row, int32_t column) {
        std::vector<Run>& tile = runs[{row, column}];
        const bool goes_on =
            !tile.empty() && tile.back().element == e && (is_whole || tile.back().last == i);
        if (!goes_on) {
          tile.push_back({e, is_whole ? 0 : i, is_whole ? count - 1 : i + 1});
        } else if (!is_whole) {
          tile.back().last = i + 1;
        }
      });
    }
  }
  return runs;
}

std::string encode_rest(const HdMap& map) {
  CompactEncoder rest;
  const auto is_short = [](const MapElement& element) { return element.points.size() < 2; };
  rest.number(static_cast<uint64_t>(std::ranges::count_if(map.elements, is_short)));
  for (size_t i = 0; i < map.elements.size(); ++i) {
    const MapElement& element = map.elements[i];
    if (!is_short(element)) continue;
    rest.number(i);
    rest.byte(static_cast<uint8_t>(element.element_class));
    rest.byte(static_cast<uint8_t>(element.appearance));
    rest.polyline(element.points);
  }
  encode_lanes(map.lanes, rest);
  return rest.bytes();
}

TileHeader header_of(const HdMap& map) {
  TileHeader header;
  header.checksum = map_checksum(map);
  header.elements = static_cast<uint32_t>(map.elements.size());
  header.lanes = static_cast<uint32_t>(map.lanes.size());
  for (const MapElement& element : map.elements) {
    ++header.of_class[static_cast<size_t>(element.element_class)];
  }
  header.tile_quanta = static_cast<uint32_t>(kTileQuanta);
  header.name_size = static_cast<uint32_t>(map.name.size());
  header.latitude_bits = std::bit_cast<uint64_t>(map.origin.latitude_deg);
  header.longitude_bits = std::bit_cast<uint64_t>(map.origin.longitude_deg);
  return header;
}

std::string bytes_of(const TileHeader& header) {
  std::string bytes(kMapMagic);
  append_fixed(bytes, kTiledVersion);
  append_fixed(bytes, uint16_t{0});
  TileHeader::each(header, [&bytes](auto value) { append_fixed(bytes, value); });
  bytes.resize(kHeaderCrcOffset, '\0');
  append_fixed(bytes, crc32(bytes));
  return bytes;
}

}  // namespace

std::string encode_tiles(const HdMap& map) {
  std::vector<std::vector<QuantisedPoint>> elements;
  for (const MapElement& element : map.elements) elements.push_back(quantised(element.points));
  const Runs runs = runs_of(map, elements);
  TileHeader header = header_of(map);
  header.tiles = static_cast<uint32_t>(runs.size());
  const uint64_t tiles_offset = kTileHeaderSize + map.name.size() + runs.size() * kTileEntrySize;
  std::string directory = map.name;
  std::string tiles;
  for (const auto& [place, tile_runs] : runs) {
    CompactEncoder tile;
    uint32_t last_element = 0;
    for (const Run& run : tile_runs) {
      const MapElement& element = map.elements[run.element];
      tile.number(run.element - last_element);
      last_element = run.element;
      tile.number(run.first);
      tile.byte(static_cast<uint8_t>(static_cast<unsigned>(element.element_class) |
                                     static_cast<unsigned>(element.appearance) << 2U));
      tile.number(run.last - run.first + 1);
      tile.start_from(place.second * kTileQuanta, place.first * kTileQuanta);
      for (uint32_t i = run.first; i <= run.last; ++i) {
        tile.coordinate(0, elements[run.element][i].x);
        tile.coordinate(1, elements[run.element][i].y);
      }
    }
    append_fixed(directory, static_cast<uint32_t>(place.second));
    append_fixed(directory, static_cast<uint32_t>(place.first));
    append_fixed(directory, uint64_t{tiles_offset + tiles.size()});
    append_fixed(directory, static_cast<uint32_t>(tile.bytes().size()));
    append_fixed(directory, crc32(tile.bytes()));
    tiles += tile.bytes();
  }
  const std::string rest = encode_rest(map);
  header.rest_offset = tiles_offset + tiles.size();
  header.rest_size = rest.size();
  header.rest_crc = crc32(rest);
  header.directory_crc = crc32(directory);
  header.file_size = header.rest_offset + rest.size();
  return bytes_of(header) + directory + tiles + rest;
}

}  // namespace bevloc
