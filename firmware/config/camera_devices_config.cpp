#include "firmware/config/camera_devices_config.h"

#include <algorithm>

#include <fmt/ranges.h>

#include "firmware/config/config_milliseconds.h"

namespace bevloc::firmware {
namespace {

const NamedPixelFormat* find_format(const std::string& name) {
  const auto found = std::ranges::find(kPixelFormats, name, &NamedPixelFormat::name);
  return found == kPixelFormats.end() ? nullptr : &*found;
}

std::vector<PixelFormat> read_formats(YamlMap& yaml, const std::vector<PixelFormat>& fallback) {
  std::vector<std::string> fallback_names;
  for (const PixelFormat format : fallback) fallback_names.emplace_back(to_string(format));
  std::vector<std::string> names;
  for (const NamedPixelFormat& format : kPixelFormats) names.emplace_back(format.name);
  const Wanted<std::string> known = one_of(names);
  std::vector<PixelFormat> formats;
  for (const std::string& name : yaml.optional_list("formats", fallback_names, 0, known)) {
    if (const NamedPixelFormat* format = find_format(name)) formats.push_back(format->format);
  }
  if (formats.empty()) yaml.reject("formats", "no known format", known.description);
  return formats;
}

}  // namespace

CameraDevicesConfig read_camera_devices(YamlMap& cameras) {
  CameraDevicesConfig config;
  YamlMap ids = cameras.require_map("ids");
  const Wanted<std::string> named{
      "a persistent camera id, not /dev/video...",
      [](const std::string& id) { return !id.empty() && !id.starts_with("/dev/video"); },
      {.low = 1.0}};
  for (int camera = 0; camera < kCameraCount; ++camera) {
    config.ids[camera] = ids.require<std::string>(kCameraNames[camera], named);
  }
  for (int camera = 1; camera < kCameraCount; ++camera) {
    const auto before = config.ids.begin() + camera;
    const std::string& id = config.ids[camera];
    if (!id.empty() && std::find(config.ids.begin(), before, id) != before) {
      ids.reject(kCameraNames[camera], "the id of another camera",
                 "a different id for each camera");
    }
  }
  config.formats = read_formats(cameras, config.formats);
  config.rate_hz = cameras.optional<double>("rate_hz", config.rate_hz, between(0.1, 240.0));
  config.memory = cameras.optional_choice<CameraMemory>(
      "memory", config.memory, {{"mmap", CameraMemory::kMmap}, {"dmabuf", CameraMemory::kDmabuf}});
  if (cameras.has("controls")) {
    for (YamlMap& control : cameras.require_map_list("controls")) {
      config.controls.push_back(
          {control.require<std::string>("name"), control.require<double>("value")});
    }
  }
  const auto duration_ms = between(0.0, 1000.0);
  config.exposure = optional_milliseconds(cameras, "exposure_ms", config.exposure, duration_ms);
  if (cameras.has("readout_ms")) {
    config.readout = require_milliseconds(cameras, "readout_ms", duration_ms);
  }
  return config;
}

drivers::DeviceCameraConfig device_camera(const CameraDevicesConfig& config, int buffers,
                                          const Rig& rig, int camera) {
  drivers::DeviceCameraConfig device;
  device.camera = camera;
  device.id = config.ids[camera];
  device.width_px = rig.cameras[camera].intrinsics.width_px;
  device.height_px = rig.cameras[camera].intrinsics.height_px;
  device.formats = config.formats;
  device.rate_hz = config.rate_hz;
  device.buffers = buffers;
  device.controls = config.controls;
  device.exposure = config.exposure;
  device.readout = config.readout;
  return device;
}

}  // namespace bevloc::firmware
