// Simulates the mask that a camera network would output: the visible lines with realistic errors.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/perception/visible_lines.h"

namespace bevloc::sim {

/// Strength of the errors. IoU per class (divider / crossing / boundary): kMild about 0.70 / 0.60 /
/// 0.70, kPaper 0.578 / 0.422 / 0.578 as in the paper's Table II, kHard about 0.23 / 0.15 / 0.21.
enum class CorruptionLevel : uint8_t { kClean = 0, kMild = 1, kPaper = 2, kHard = 3 };
inline constexpr int kCorruptionLevels = 4;

const char* name(CorruptionLevel level);

/// Lines up to this far outside the raster can still affect it.
inline constexpr double kPerceptionMargin_m = 3.0;

/// Draws the lines as a network would perceive them, as probabilities.
///
/// Errors: some stretches are missed, more often far away and behind obstacles. Each line is
/// displaced smoothly and independently of the others, mostly along the viewing ray; the dashes of
/// one line move together. Width, confidence and blur vary. Some lines are invented. No error is
/// common to the whole scene, so the pose is not biased. At kClean there are no errors and the mask
/// equals the map's raster. One seed gives the same obstacles, false lines and error shapes at
/// every level.
///
/// `lines` are visible_lines() with a margin of kPerceptionMargin_m. `mask` has kRasterSize values,
/// [ElementClass][row][column] of kRasterGrid. It is overwritten completely.
void draw_perceived(const std::vector<VisibleLine>& lines, CorruptionLevel level, uint64_t seed,
                    std::span<float> mask);

}  // namespace bevloc::sim
