// The view table: which image features each BEV cell reads. It is computed from the rig, so the
// network needs no weights to go from images to BEV (the idea of GKT).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/bev_grid.h"
#include "pipeline/calibration/rig.h"

namespace bevloc {

/// Stride in pixels and size of the image features that BEV cells read: 12 x 40 per camera.
inline constexpr int kImageFeatureStride = 8;
inline constexpr int kImageFeatureRows = 12;
inline constexpr int kImageFeatureCols = 40;
inline constexpr int kImageFeatureCells = kImageFeatureRows * kImageFeatureCols;

/// Entries per BEV cell: two cameras with four bilinear neighbours each.
inline constexpr int kViewSlots = 8;

/// The entry for slot s and BEV cell c (row-major) is at s * cells + c. `index` is the position in
/// the features of all six cameras: camera * kImageFeatureCells + row * kImageFeatureCols + col.
/// `weight` is at least 0. The weights of a cell sum to 1, or are all 0 if no camera sees the cell.
struct ViewTable {
  std::vector<int32_t> index;
  std::vector<float> weight;
};

/// Projects the centre of each BEV cell, on the ground (z = 0), into the available network cameras
/// and keeps the two cameras that see it best. A camera's share of a cell falls to zero towards the
/// border of its image, so the table is continuous where cameras overlap.
///
/// `rig` is the network rig (network_rig()), whose cameras have no distortion.
/// `reference_from_exposure` is the vehicle's pose at each camera's exposure, in the vehicle frame
/// at the reference time. The cells lie in that frame.
ViewTable make_view_table(const Rig& rig, CameraMask available, const BevGrid& grid,
                          const CameraMotions& reference_from_exposure = {});

/// Like make_view_table(), but writes into `table`. Does not allocate if the table already has this
/// size.
void update_view_table(const Rig& rig, CameraMask available, const BevGrid& grid,
                       const CameraMotions& reference_from_exposure, ViewTable& table);

}  // namespace bevloc
