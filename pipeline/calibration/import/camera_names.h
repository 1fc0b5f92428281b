// Chooses the names of imported cameras.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/calibration/import/imported_camera.h"

namespace bevloc::calibration_import {

/// Whether this is one of kCameraNames.
bool is_ours(std::string_view name);

/// Renames cameras after their file (ImportedCamera::file_stem), because some programs give each
/// camera the same name. If the stem is one of kCameraNames, the camera takes it, unless no other
/// camera has its name and this name is one of kCameraNames or in `our_names`. Any other stem
/// replaces only a name that several cameras have and that is not one of kCameraNames.
void name_after_files(const std::map<std::string, std::string>& our_names,
                      std::vector<ImportedCamera>& cameras);

}  // namespace bevloc::calibration_import
