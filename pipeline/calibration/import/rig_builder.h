// Makes our rig from imported cameras: finds their names and their places on the vehicle.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pipeline/calibration/import/import_rig.h"
#include "pipeline/calibration/import/imported_camera.h"

namespace bevloc::calibration_import {

/// Where a camera's values come from, as messages name the place.
struct CameraSource {
  std::string intrinsics;
  std::string extrinsics;
};

struct BuiltRig {
  Rig rig;
  /// One sentence per camera of the rig, then one per camera that is left out.
  std::vector<std::string> notes;
  std::array<CameraSource, kCameraCount> sources;
};

/// Throws ImportError if a camera or its place is missing, or if one of the options is not needed.
BuiltRig build_rig(std::vector<ImportedCamera> cameras, const RigImportOptions& options);

}  // namespace bevloc::calibration_import
