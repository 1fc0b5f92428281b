// The files that a configuration consists of.
#pragma once

#include <filesystem>
#include <vector>

#include "common/output_file.h"
#include "firmware/config/config.h"
#include "firmware/config/config_key.h"

namespace bevloc::firmware {

/// The file of the configuration, and the files that are read because it names them. An entry is
/// empty if the configuration names no such file.
inline std::vector<std::filesystem::path> files_of(const Config& config) {
  std::vector<std::filesystem::path> files{config.file,         config.rig_file,
                                           config.map_file,     config.model_file,
                                           config.can.dbc_file, config.manifest_file};
  if (config.can.secoc) {
    files.insert(files.end(), {config.can.secoc->key_file, config.can.secoc->starts_file});
  }
  return files;
}

/// Fails if the file of the learned calibration is also one of files_of(), which bevlocd would then
/// lose: it replaces the file of the learned calibration without a backup.
inline Status check_learned_file(const Config& config) {
  return at_key("calibration.online.file",
                check_output(config.learned_calibration_file, files_of(config)));
}

}  // namespace bevloc::firmware
