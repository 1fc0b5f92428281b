// Which image features each BEV cell gathers: geometry chooses the keys (GKT's idea), a table made
// from the calibration holds them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/bev_grid.h"
#include "pipeline/calibration/rig.h"

namespace bevloc {

/// Stride of the image features that are gathered: 12 x 40 cells per camera.
inline constexpr int kImageFeatureStride = 8;
inline constexpr int kImageFeatureRows = 12;
inline constexpr int kImageFeatureCols = 40;
inline constexpr int kImageFeatureCells = kImageFeatureRows * kImageFeatureCols;

/// Two cameras a cell, four bilinear neighbours each.
inline constexpr int kViewSlots = 8;

/// For slot s and BEV cell c (row-major): index[s * cells + c] points into the features of all six
/// cameras, camera * kImageFeatureCells + row * kImageFeatureCols + col, and weight[...] >= 0.
/// The weights of a cell sum to 1, or all are 0 where no camera sees the ground.
struct ViewTable {
  std::vector<int32_t> index;
  std::vector<float> weight;
};

/// Projects each BEV cell's centre on the ground (z = 0) into the network cameras that `available`
/// names, and keeps the two that see it best: a camera's share falls to zero towards its image
/// border, so that nothing jumps where cameras overlap. `rig` is the network rig (network_rig()),
/// whose cameras have no distortion. The cells lie around the vehicle at the reference time; each
/// camera looks at them from where its exposure was (`reference_from_exposure`).
ViewTable make_view_table(const Rig& rig, CameraMask available, const BevGrid& grid,
                          const CameraMotions& reference_from_exposure = {});

/// The same into a table that is there already: no allocation once it has been filled before.
void update_view_table(const Rig& rig, CameraMask available, const BevGrid& grid,
                       const CameraMotions& reference_from_exposure, ViewTable& table);

}  // namespace bevloc
