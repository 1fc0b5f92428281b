// BEV images as JSON, for script/figures.
#pragma once

#include <cstdint>
#include <span>

#include <nlohmann/json_fwd.hpp>

#include "pipeline/bev_grid.h"

namespace bevloc::evaluation {

/// [row][column] of one plane, rounded to four decimals.
nlohmann::json plane_json(std::span<const float> plane, int rows, int cols);

/// [channel][row][column], rounded to four decimals.
nlohmann::json planes_json(std::span<const float> planes, const BevGrid& grid);

/// [channel][row][column] on kRasterGrid with values 0 to 255: of a map's raster, and of a mask's
/// probabilities.
nlohmann::json bytes_json(std::span<const uint8_t> raster);
nlohmann::json bytes_json(std::span<const float> mask);

}  // namespace bevloc::evaluation
