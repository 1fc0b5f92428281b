// Reads the keys of a rig file. parse_rig() and the schema of rig files (command/schema) use it.
#pragma once

#include <vector>

#include "common/strict_yaml.h"
#include "pipeline/calibration/rig.h"

namespace bevloc {

/// The mappings of a rig file, in the order of kCameraNames.
struct RigKeys {
  std::vector<YamlMap> intrinsics;
  std::vector<YamlMap> mountings;
};

/// YamlMap::finish() reports mistakes. What the numbers mean is not checked.
Rig read_rig_keys(YamlMap& yaml, RigKeys& keys);

}  // namespace bevloc
