// Maps of all formats: loads, draws and stores them.
#include <cmath>

#include "common/crc32.h"
#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/map_check.h"
#include "pipeline/map/rasterizer.h"
#include "pipeline/map/tiles/tile_codec.h"
#include "tests/fuzz/targets.h"

namespace bevloc::fuzz {
namespace {

void append_little_endian(std::string& bytes, uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<char>(value >> (8 * i)));
}

/// A file with this body and a right header and CRC, which libFuzzer would hardly find.
std::string framed(std::string_view body) {
  constexpr uint32_t kVersion = 1;
  std::string file(kMapMagic);
  append_little_endian(file, kVersion, 2);
  append_little_endian(file, static_cast<uint32_t>(body.size()), 4);
  file += body;
  append_little_endian(file, crc32(file), 4);
  return file;
}

void use(const HdMap& map) {
  const MapIndex index(map);
  static std::vector<uint8_t> raster(kRasterSize);
  MapRasterizer rasterizer(index);
  for (const MapElement& element : map.elements) {
    if (element.points.size() < 2) continue;
    const Eigen::Vector2d& place = element.points[1];
    expect(place.allFinite(), "a point of a map that is not finite");
    rasterizer.draw({place.x(), place.y(), 0.3}, raster);
    break;
  }
  const auto again = decode_map(encode_map(map), "again.bvm");
  expect(again.has_value(), "a loaded map that cannot be stored and read again");
  expect(again->elements.size() == map.elements.size(), "another number of elements when stored");
  expect(check_map(*again, "again.bvm").has_value(), "a stored map that is refused");
  const auto tiled = decode_map(encode_tiles(map), "tiled.bvm");
  expect(tiled.has_value(), "a loaded map that cannot be stored in tiles and read again");
  expect(encode_map(*tiled) == encode_map(*again), "another map when stored in tiles");
}

void use_parsed(std::string_view bytes, const char* file) {
  const auto imported = parse_imported(bytes, file, {});
  if (imported) use(imported->map);
}

}  // namespace

void run_bvm(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  use_parsed(text.starts_with(kMapMagic) ? text : framed(text), "fuzz.bvm");
}

void run_osm(Bytes bytes) {
  use_parsed(text_of(bytes), "fuzz.osm");
}

void run_xodr(Bytes bytes) {
  use_parsed(text_of(bytes), "fuzz.xodr");
}

void run_map_json(Bytes bytes) {
  use_parsed(text_of(bytes), "fuzz.geojson");
}

}  // namespace bevloc::fuzz
