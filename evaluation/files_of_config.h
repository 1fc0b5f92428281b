// The files that a configuration consists of.
#pragma once

#include <filesystem>
#include <vector>

#include "firmware/config/config.h"

namespace bevloc::evaluation {

/// The file of the configuration, and the files that are read because it names them. An entry is
/// empty if the configuration names no such file.
inline std::vector<std::filesystem::path> files_of(const firmware::Config& config) {
  std::vector<std::filesystem::path> files{config.file,         config.rig_file,
                                           config.map_file,     config.model_file,
                                           config.can.dbc_file, config.manifest_file};
  if (config.can.secoc) files.push_back(config.can.secoc->key_file);
  return files;
}

}  // namespace bevloc::evaluation
