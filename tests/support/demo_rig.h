// The rig of the demo.
#pragma once

#include "pipeline/calibration/rig_yaml.h"

namespace bevloc::test {

inline Rig demo_rig() {
  return read_rig(BEVLOC_SOURCE_DIR "/config/rig_demo.yaml").value();
}

}  // namespace bevloc::test
