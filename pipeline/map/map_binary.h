// The compact map file (.bvm) that an appliance carries: a few kilobytes per kilometre of road.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Points are kept to the millimetre.
inline constexpr double kMapQuantumM = 0.001;

/// First bytes of every such file.
inline constexpr std::string_view kMapMagic = "BVMP";

/// Layout, all numbers little endian:
///
///     magic "BVMP" | version u16 | bytes of the body u32 | body | CRC-32 of all before u32
///
/// The body is a stream of varints (7 bits a byte, low ones first, the top bit says that more
/// follow), signed ones zigzag-coded, and of 64-bit IEEE numbers:
///
///     name: length, bytes
///     origin: latitude, longitude (f64, degrees)
///     elements: count, then each: class, appearance, polyline
///     lanes: count, then each: left, right, centerline (polylines), speed limit (f64, m/s),
///            successors: count, indices
///     polyline: count, then each point: steps of x and y in millimetres (signed) from the point
///            before it in the file; the first point's steps are from (0, 0)
///
/// Coordinates must be finite and less than 100,000 km.
std::string encode_map(const HdMap& map);

/// Fails, with `file` in the message, on anything that encode_map did not write.
Result<HdMap> decode_map(std::string_view bytes, const std::string& file);

Result<HdMap> read_map_binary(const std::filesystem::path& path);
Status write_map_binary(const HdMap& map, const std::filesystem::path& path);

}  // namespace bevloc
