// Reads and writes compact map files (.bvm), which take a few kilobytes per kilometre of road.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Resolution of the stored points.
inline constexpr double kMapQuantumM = 0.001;

/// The first bytes of every compact map file.
inline constexpr std::string_view kMapMagic = "BVMP";

/// Encodes a whole map as version 1 of the format, which every release reads. Version 2, in tiles,
/// is described in tiles/tile_codec.h. File layout, all numbers little-endian:
///
///     magic "BVMP" | version u16 | size of the body in bytes u32 | body | CRC-32 u32
///
/// The CRC-32 covers all bytes before it.
///
/// The body consists of varints (7 bits per byte, low bits first; the top bit is set if another
/// byte follows; signed numbers are zigzag-coded) and of 64-bit IEEE numbers:
///
///     name: length, bytes
///     origin: latitude, longitude (f64, degrees)
///     elements: count, then each: class, appearance, polyline
///     lanes: count, then each: left, right, centerline (polylines), speed limit (f64, m/s),
///            successors: count, indices
///     polyline: count, then for each point: x and y in millimetres (signed), as differences from
///            the previous point in the file; for the first point, from (0, 0)
///
/// Coordinates must be finite and below 100,000 km.
std::string encode_map(const HdMap& map);

/// Decodes a map of either version. Fails, with `file` in the message, unless encode_map() or
/// encode_tiles() wrote the bytes.
Result<HdMap> decode_map(std::string_view bytes, const std::string& file);

/// Writes version 1.
Status write_map_binary(const HdMap& map, const std::filesystem::path& path);
/// Writes version 2. Fails if check_map() does not hold.
Status write_tiled_map(const HdMap& map, const std::filesystem::path& path);

}  // namespace bevloc
