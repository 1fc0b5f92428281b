// The checksum of a map's content, which is the same for every file format.
#pragma once

#include <cstdint>

#include "pipeline/map/hd_map.h"

namespace bevloc {

/// CRC-32 over what the localizer uses: the origin, and the elements with their classes and points
/// in their order. Points are rounded to kMapQuantumM, as a compact map does, so an OSM file and
/// the compact map that was converted from it have the same checksum.
uint32_t map_checksum(const HdMap& map);

}  // namespace bevloc
