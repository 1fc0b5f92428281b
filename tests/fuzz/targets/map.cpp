// Maps of all formats: loads, draws and stores them.
#include <cmath>
#include <vector>

#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/map_check.h"
#include "pipeline/map/rasterizer.h"
#include "pipeline/map/tiles/tile_codec.h"
#include "pipeline/map/tiles/tiled_map.h"
#include "tests/fuzz/targets.h"
#include "tests/pipeline/map/framed_map.h"
#include "tests/pipeline/map/tiles/tile_file_changes.h"

namespace bevloc::fuzz {
namespace {

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

/// A file of version 2 with right sizes and checksums.
std::string with_right_checksums(std::string_view tiled) {
  std::string file(tiled);
  test::state_tile_sizes(file);
  test::state_tile_checksums(file);
  return file;
}

/// Queries a file of version 2 on disk. Its tiles are checked when they are read, not as a whole.
void use_tiles(const std::string& file) {
  const auto* bytes = reinterpret_cast<const uint8_t*>(file.data());
  const auto map = TiledMap::open(path_of_file_with({bytes, file.size()}));
  if (!map) return;
  constexpr double kFar_m = 1e9;
  std::vector<TiledMap::Segment> found;
  (*map)->query({-kFar_m, -kFar_m}, {kFar_m, kFar_m}, found);
  for (const TiledMap::Segment& segment : found) {
    expect(segment.element < (*map)->facts().elements, "a segment of an element beyond the last");
    expect(static_cast<size_t>(segment.element_class) < kElementClasses, "an unknown class");
    expect(static_cast<size_t>(segment.appearance) < kAppearances, "an unknown appearance");
    expect(segment.from.allFinite() && segment.to.allFinite(), "a segment that is not finite");
  }
}

}  // namespace

void run_bvm(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  use_parsed(text.starts_with(kMapMagic) ? text : test::framed_map(text), "fuzz.bvm");
  if (!is_tiled(text) || text.size() < kTileHeaderSize) return;
  const std::string tiled = with_right_checksums(text);
  use_parsed(tiled, "fuzz.bvm");
  use_tiles(tiled);
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
