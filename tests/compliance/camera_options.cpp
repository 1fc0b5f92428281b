#include "tests/compliance/camera_options.h"

#include <utility>

namespace bevloc::drivers {

CameraOptions::CameraOptions(CLI::App& app) {
  DeviceCameraConfig& common = devices_.common;
  common.width_px = 640;
  common.height_px = 360;
  const auto group = app.add_option_group("Cameras");
  group->add_option("--v4l2", devices_.v4l2, "V4L2 cameras by stable id, with mapped memory");
  group->add_option("--v4l2-dmabuf", devices_.v4l2_dmabuf,
                    "V4L2 cameras by stable id, with dmabuf");
  group->add_option("--libcamera", devices_.libcamera, "Cameras of libcamera by id");
  group->add_option("--width", common.width_px, "Width in pixels")->capture_default_str();
  group->add_option("--height", common.height_px, "Height in pixels")->capture_default_str();
  group->add_option("--rate", common.rate_hz, "Frames per second; 0 keeps the rate of the device")
      ->capture_default_str();
  std::vector<std::string> known;
  for (const NamedPixelFormat& format : kPixelFormats) known.emplace_back(format.name);
  group->add_option("--formats", formats_, "Pixel formats in order of preference")
      ->check(CLI::IsMember(known));
  group->add_option("--exposure-ms", exposure_ms_, "Exposure time");
  group->add_option("--readout-ms", readout_ms_,
                    "Read-out time, for cameras that stamp the end of a frame");
  group->add_option("--control", controls_, "Control NAME=VALUE, set at each start");
  group->add_option("--unplug-command", devices_.unplug_command,
                    "Shell command that unplugs the camera");
  group->add_option("--replug-command", devices_.replug_command,
                    "Shell command that plugs the camera in again");
}

void CameraOptions::apply() {
  DeviceCameraConfig& common = devices_.common;
  for (const std::string& name : formats_) {
    for (const NamedPixelFormat& format : kPixelFormats) {
      if (format.name == name) common.formats.push_back(format.format);
    }
  }
  common.exposure = from_seconds(1e-3 * exposure_ms_);
  if (readout_ms_ > 0.0) common.readout = from_seconds(1e-3 * readout_ms_);
  for (const std::string& control : controls_) {
    const size_t equals = control.find('=');
    common.controls.push_back({control.substr(0, equals), std::stod(control.substr(equals + 1))});
  }
  camera_devices() = std::move(devices_);
}

}  // namespace bevloc::drivers
