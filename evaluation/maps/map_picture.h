// Draws maps with a legend and a scale bar.
#pragma once

#include <string>

#include "common/result.h"
#include "evaluation/maps/map_diff.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {

/// Draws a whole map, north up, into a square PNG file.
Status write_map_picture(const HdMap& map, int size_px, const std::string& path);

/// Draws what two maps have in common, and what only one of them has.
Status write_diff_picture(const MapDiff& diff, int size_px, const std::string& path);

}  // namespace bevloc::evaluation
