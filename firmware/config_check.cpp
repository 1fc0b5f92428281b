// What a configuration names, looked up on the disk.
#include <string_view>

#include "drivers/camera/replay_camera.h"
#include "firmware/config.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc::firmware {
namespace {

Status require_file(const std::filesystem::path& file, std::string_view what) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) return {};
  return fail("{}: found no such file, wanted the {}", file.string(), what);
}

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
  if (Status model = require_file(config.model_file, "network's model"); !model) return model;
  if (!config.map.procedural_seed) {
    if (Status map = require_file(config.map.file, "HD map"); !map) return map;
  }
  if (config.cameras.driver == CameraDriver::kReplay) {
    return check_recordings(config.cameras.recording);
  }
  return {};
}

}  // namespace bevloc::firmware
