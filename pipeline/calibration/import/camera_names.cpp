#include "pipeline/calibration/import/camera_names.h"

#include <algorithm>

#include "common/cameras.h"

namespace bevloc::calibration_import {

bool is_ours(std::string_view name) {
  return std::ranges::find(kCameraNames, name) != kCameraNames.end();
}

void name_after_files(const std::map<std::string, std::string>& our_names,
                      std::vector<ImportedCamera>& cameras) {
  std::map<std::string, int> count;
  for (const ImportedCamera& camera : cameras) ++count[camera.name];
  for (ImportedCamera& camera : cameras) {
    if (camera.file_stem.empty()) continue;
    const bool is_shared = count.at(camera.name) > 1;
    const bool is_known = is_ours(camera.name) || our_names.contains(camera.name);
    const bool takes_stem =
        is_ours(camera.file_stem) ? is_shared || !is_known : is_shared && !is_ours(camera.name);
    if (takes_stem) camera.name = camera.file_stem;
  }
}

}  // namespace bevloc::calibration_import
