// Compares the lines that the network perceived with those of a map.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "pipeline/bev_grid.h"

namespace bevloc::evaluation {

/// How well one class was perceived, within kPerceivedWithin_m.
struct ClassScore {
  double recall = 0.0;     ///< share of the mapped cells with a perceived cell nearby
  double precision = 0.0;  ///< share of the perceived cells with a mapped cell nearby
  int mapped = 0;          ///< cells; without any the recall means nothing
  int perceived = 0;       ///< cells; without any the precision means nothing
};

inline constexpr double kPerceivedWithin_m = 0.45;

/// The scores of the classes in the order of ElementClass.
using PerceptionScore = std::array<ClassScore, kRasterChannels>;

/// `logits`: the network's mask [3, 400, 200]. `raster`: the map at the same pose, as MapRasterizer
/// draws it.
PerceptionScore score_perception(std::span<const float> logits, std::span<const uint8_t> raster);

}  // namespace bevloc::evaluation
