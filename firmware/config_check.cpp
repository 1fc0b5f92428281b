// What a configuration names, looked up on the disk.
#include <string_view>

#include "drivers/camera/replay_camera.h"
#include "firmware/config.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_loader.h"
#include "pipeline/network/network.h"

namespace bevloc::firmware {
namespace {

Status check_recordings(const std::filesystem::path& folder) {
  for (const std::string_view camera : kCameraNames) {
    const auto recording = drivers::load_recording(folder / camera);
    if (!recording) return tl::unexpected(recording.error());
  }
  return {};
}

}  // namespace

Status check_config(const Config& config) {
  if (const auto rig = read_rig(config.rig_file); !rig) return tl::unexpected(rig.error());
  if (const auto model = Network::load(config.model_file, {}); !model) {
    return tl::unexpected(model.error());
  }
  if (!config.map.procedural_seed) {
    if (const auto map = load_map(config.map.file); !map) return tl::unexpected(map.error());
  }
  if (config.cameras.driver == CameraDriver::kReplay) {
    return check_recordings(config.cameras.recording);
  }
  return {};
}

}  // namespace bevloc::firmware
