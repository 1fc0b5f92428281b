// Draws the map over the pictures of one frameset, with one rig or with two.
#pragma once

#include <string>
#include <vector>

#include "pipeline/calibration/refine/picture_recording.h"
#include "pipeline/calibration/refine/refinement.h"
#include "pipeline/map/map_index.h"

namespace bevloc::evaluation {

/// A calibration with which the map is drawn over the pictures.
struct CalibrationView {
  std::string title;
  Rig rig;
  std::array<double, kCameraCount> time_offset_s{};
};

/// Writes a PNG file: for each view a title and the pictures of the six cameras, with the map at
/// the reference pose of each picture's time. Dividers are blue, crossings green, boundaries red.
Status write_calibration_picture(const std::vector<CalibrationView>& views,
                                 const std::vector<RecordedPicture>& pictures,
                                 const ReferenceTrajectory& reference, const MapIndex& map,
                                 const std::string& file);

}  // namespace bevloc::evaluation
