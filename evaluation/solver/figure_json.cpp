#include "evaluation/solver/figure_json.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

namespace bevloc::evaluation {
namespace {

/// [row][column] of `values`, each converted by `convert`.
template <typename Value, typename Convert>
nlohmann::json rows_json(std::span<const Value> values, int cols, Convert convert) {
  nlohmann::json rows = nlohmann::json::array();
  for (size_t first = 0; first < values.size(); first += static_cast<size_t>(cols)) {
    nlohmann::json row = nlohmann::json::array();
    for (const Value value : values.subspan(first, static_cast<size_t>(cols))) {
      row.push_back(convert(value));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

template <typename Value, typename Convert>
nlohmann::json channels_json(std::span<const Value> values, const BevGrid& grid, Convert convert) {
  const auto cells = static_cast<size_t>(grid.cells());
  nlohmann::json channels = nlohmann::json::array();
  for (size_t first = 0; first < values.size(); first += cells) {
    channels.push_back(rows_json(values.subspan(first, cells), grid.cols, convert));
  }
  return channels;
}

double rounded(float value) {
  return std::round(1e4 * value) / 1e4;
}

}  // namespace

nlohmann::json plane_json(std::span<const float> plane, int rows, int cols) {
  return rows_json(plane.first(static_cast<size_t>(rows) * cols), cols, rounded);
}

nlohmann::json planes_json(std::span<const float> planes, const BevGrid& grid) {
  return channels_json(planes, grid, rounded);
}

nlohmann::json bytes_json(std::span<const uint8_t> raster) {
  return channels_json(raster, kRasterGrid, [](uint8_t value) { return int{value}; });
}

nlohmann::json bytes_json(std::span<const float> mask) {
  return channels_json(mask, kRasterGrid, [](float probability) {
    return static_cast<int>(std::lround(255.0F * std::clamp(probability, 0.0F, 1.0F)));
  });
}

}  // namespace bevloc::evaluation
