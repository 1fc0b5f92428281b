#include "pipeline/map/map_binary.h"

#include <cstdint>

#include "common/crc32.h"
#include "common/replace_file.h"
#include "pipeline/map/compact_codec.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/map_check.h"
#include "pipeline/map/tiles/tile_codec.h"

namespace bevloc {
namespace {

constexpr uint16_t kVersion = 1;
constexpr size_t kVersionOffset = kMapMagic.size();
constexpr size_t kSizeOffset = kVersionOffset + sizeof(uint16_t);
constexpr size_t kHeaderSize = kSizeOffset + sizeof(uint32_t);
constexpr size_t kCrcSize = sizeof(uint32_t);

MapElement decode_element(CompactDecoder& decoder) {
  MapElement element;
  element.element_class =
      static_cast<ElementClass>(decoder.number_below(kElementClasses, "an unknown class"));
  element.appearance =
      static_cast<Appearance>(decoder.number_below(kAppearances, "an unknown appearance"));
  element.points = decoder.polyline();
  return element;
}

Lane decode_lane(CompactDecoder& decoder, size_t lane_count) {
  constexpr double kMaxSpeedMps = 1000.0;
  Lane lane;
  lane.left = decoder.polyline();
  lane.right = decoder.polyline();
  lane.centerline = decoder.polyline();
  lane.speed_limit_mps = decoder.real(kMaxSpeedMps, "a speed limit beyond 1000 m/s");
  lane.successors.resize(decoder.count(1));
  for (uint32_t& successor : lane.successors) {
    successor =
        static_cast<uint32_t>(decoder.number_below(lane_count, "a successor beyond the last lane"));
  }
  const bool has_bounds = lane.left.size() > 1 && lane.right.size() > 1;
  if (!has_bounds || polyline_length(lane.centerline) == 0.0) decoder.reject("a lane of no length");
  return lane;
}

HdMap decode_body(CompactDecoder& decoder) {
  constexpr size_t kSmallestElement = 3;
  HdMap map;
  map.name = decoder.text();
  map.origin.latitude_deg = decoder.real(90.0, "a latitude beyond 90 degrees");
  map.origin.longitude_deg = decoder.real(180.0, "a longitude beyond 180 degrees");
  map.elements.resize(decoder.count(kSmallestElement));
  for (MapElement& element : map.elements) element = decode_element(decoder);
  map.lanes = decode_lanes(decoder);
  if (!decoder.at_end()) decoder.reject("more bytes after the last lane");
  return map;
}

/// Checks size, magic, version and CRC, then returns the body.
Result<std::string_view> body_of(std::string_view bytes, const std::string& file) {
  if (bytes.size() < kHeaderSize + kCrcSize) {
    return fail("{}: found {} bytes, wanted a map file of at least {}", file, bytes.size(),
                kHeaderSize + kCrcSize);
  }
  if (!bytes.starts_with(kMapMagic)) {
    return fail("{}: found a different magic number, wanted \"{}\"", file, kMapMagic);
  }
  if (const auto version = fixed_at<uint16_t>(bytes, kVersionOffset); version != kVersion) {
    return fail("{}: found version {} of the format, wanted {} or {}", file, version, kVersion,
                kTiledVersion);
  }
  const size_t size = fixed_at<uint32_t>(bytes, kSizeOffset);
  if (bytes.size() != kHeaderSize + size + kCrcSize) {
    return fail("{}: found {} bytes, wanted {} as its header states", file, bytes.size(),
                kHeaderSize + size + kCrcSize);
  }
  const std::string_view checked = bytes.substr(0, kHeaderSize + size);
  const uint32_t found = crc32(checked);
  if (const auto wanted = fixed_at<uint32_t>(bytes, checked.size()); found != wanted) {
    return fail("{}: found CRC-32 {:08x}, wanted {:08x} as the file states", file, found, wanted);
  }
  return checked.substr(kHeaderSize);
}

}  // namespace

void encode_lanes(const std::vector<Lane>& lanes, CompactEncoder& body) {
  body.number(lanes.size());
  for (const Lane& lane : lanes) {
    body.polyline(lane.left);
    body.polyline(lane.right);
    body.polyline(lane.centerline);
    body.real(lane.speed_limit_mps);
    body.number(lane.successors.size());
    for (const uint32_t successor : lane.successors) body.number(successor);
  }
}

std::vector<Lane> decode_lanes(CompactDecoder& decoder) {
  constexpr size_t kSmallestLane = 3 + sizeof(double) + 1;
  std::vector<Lane> lanes(decoder.count(kSmallestLane));
  for (Lane& lane : lanes) lane = decode_lane(decoder, lanes.size());
  return lanes;
}

std::string encode_map(const HdMap& map) {
  CompactEncoder body;
  body.text(map.name);
  body.real(map.origin.latitude_deg);
  body.real(map.origin.longitude_deg);
  body.number(map.elements.size());
  for (const MapElement& element : map.elements) {
    body.number(static_cast<uint64_t>(element.element_class));
    body.number(static_cast<uint64_t>(element.appearance));
    body.polyline(element.points);
  }
  encode_lanes(map.lanes, body);
  std::string bytes(kMapMagic);
  append_fixed(bytes, kVersion);
  append_fixed(bytes, static_cast<uint32_t>(body.bytes().size()));
  bytes += body.bytes();
  append_fixed(bytes, crc32(bytes));
  return bytes;
}

Result<HdMap> decode_map(std::string_view bytes, const std::string& file) {
  if (is_tiled(bytes)) return decode_tiles(bytes, file);
  const Result<std::string_view> body = body_of(bytes, file);
  if (!body) return tl::unexpected(body.error());
  CompactDecoder decoder(*body);
  HdMap map = decode_body(decoder);
  if (decoder.error()) {
    return fail("{}: {}, wanted a valid compact map", file, *decoder.error());
  }
  return map;
}

Status write_map_binary(const HdMap& map, const std::filesystem::path& path) {
  return replace_file(path, encode_map(map));
}

Status write_tiled_map(const HdMap& map, const std::filesystem::path& path) {
  if (Status status = check_map(map, path.string()); !status) return status;
  return replace_file(path, encode_tiles(map));
}

}  // namespace bevloc
