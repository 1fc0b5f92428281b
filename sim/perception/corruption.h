// What a camera network would make of the road's lines: a perceived mask with realistic errors.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/perception/visible_lines.h"

namespace bevloc::sim {

/// `kPaper` reaches the IoU of the paper's Table II (0.578 divider, 0.422 crossing, 0.578
/// boundary), `kMild` about 0.70 / 0.60 / 0.70, `kHard` about 0.23 / 0.15 / 0.21.
enum class CorruptionLevel : uint8_t { kClean = 0, kMild = 1, kPaper = 2, kHard = 3 };
inline constexpr int kCorruptionLevels = 4;

const char* name(CorruptionLevel level);

/// Lines this far beyond the raster's box still leave a trace in it.
inline constexpr double kPerceptionMargin_m = 3.0;

/// Draws the lines (visible_lines with kPerceptionMargin_m) as a network would perceive them, as
/// probabilities: stretches missed (more with range, and behind obstacles), each line displaced
/// smoothly and by itself (mostly along the viewing ray; the dashes of one line together), width,
/// confidence and blur that vary, lines that are not there. No error is shared by the whole scene,
/// so the pose is not biased. At `kClean` the mask is the map's raster. The same seed gives the
/// same obstacles, false lines and shapes of error at every level.
///
/// mask: [ElementClass][row][column] of kRasterGrid, kRasterSize values, overwritten whole.
void draw_perceived(const std::vector<VisibleLine>& lines, CorruptionLevel level, uint64_t seed,
                    std::span<float> mask);

}  // namespace bevloc::sim
