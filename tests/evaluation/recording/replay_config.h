// A configuration for replays, without a section that a replay refuses.
#pragma once

#include <string>

namespace bevloc::test {

/// A configuration that replays the folder "pictures" on a mock bus. It uses the rig, map and model
/// of this tree.
inline std::string replay_config_text() {
  const std::string source = BEVLOC_SOURCE_DIR;
  return "cameras: {driver: replay, recording: pictures}\ncalibration: {rig: " + source +
         "/config/rig_demo.yaml}\nmap: {file: " + source +
         "/tests/pipeline/map/fixtures/street.osm}\nmodel: {file: " + source +
         "/models/nano.onnx}\ncan: {driver: mock}\n";
}

}  // namespace bevloc::test
