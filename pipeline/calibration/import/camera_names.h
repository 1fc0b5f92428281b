// Which names imported cameras have.
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
/// camera the same name. A camera gets the stem if this is one of kCameraNames and its name is not,
/// or if another camera has its name. It keeps a name that `our_names` maps and that no other
/// camera has. It also keeps one of kCameraNames if the stem is none.
void name_after_files(const std::map<std::string, std::string>& our_names,
                      std::vector<ImportedCamera>& cameras);

}  // namespace bevloc::calibration_import
