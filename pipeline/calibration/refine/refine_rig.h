// Compares the pictures of a drive with the map, and estimates the rig from them.
#pragma once

#include <functional>

#include "pipeline/calibration/refine/picture_recording.h"
#include "pipeline/calibration/refine/refinement.h"
#include "pipeline/map/map_index.h"

namespace bevloc {

/// With fewer framesets, a rig is not refined.
inline constexpr int kLeastFramesets = 20;

/// Called after each frameset with the number of framesets read so far and the number to be read,
/// over all rounds.
using RefinementProgress = std::function<void(int done, int all)>;

/// Reads the recording seven times. It first uses the given rig and a wide search, and later the
/// rig found so far and a narrower search. Uses framesets at least 1.5 m or 2 degrees apart.
/// Fails if the recording cannot be read, or if fewer than kLeastFramesets have reference poses.
Result<RigRefinement> refine_rig(const Rig& rig, const MapIndex& map, PictureRecording& recording,
                                 const RefinementOptions& options,
                                 const RefinementProgress& progress = {});

/// The rig with the changes applied. Time offsets are not part of a rig.
Rig refined(const Rig& rig, const RigRefinement& refinement);

}  // namespace bevloc
