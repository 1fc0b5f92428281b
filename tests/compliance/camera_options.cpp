#include "tests/compliance/camera_options.h"

#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "common/number_text.h"

namespace bevloc::drivers {
namespace {

/// Splits NAME=NUMBER. Returns nothing if the text is something else.
std::optional<ControlSetting> control_from(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return std::nullopt;
  const auto value =
      parse_number<double>(trimmed_number(std::string_view(text).substr(equals + 1)));
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return ControlSetting{text.substr(0, equals), *value};
}

/// Returns what is wrong with the text of a control, or an empty text.
std::string mistake_of_control(const std::string& text) {
  return control_from(text) ? "" : fmt::format("found {}, wanted NAME=NUMBER", text);
}

}  // namespace

CameraOptions::CameraOptions(CLI::App& app) {
  DeviceCameraConfig& common = devices_.common;
  common.width_px = 640;
  common.height_px = 360;
  const auto group = app.add_option_group("Cameras");
  group->add_option("--v4l2", devices_.v4l2, "V4L2 cameras by stable id, with mapped memory");
  group->add_option("--v4l2-dmabuf", devices_.v4l2_dmabuf,
                    "V4L2 cameras by stable id, with dmabuf");
#ifdef BEVLOC_HAS_LIBCAMERA
  group->add_option("--libcamera", devices_.libcamera, "Cameras of libcamera by id");
#endif
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
  group->add_option("--control", controls_, "Control NAME=NUMBER, set at each start")
      ->check(mistake_of_control);
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
  common.exposure = from_milliseconds(exposure_ms_);
  if (readout_ms_ > 0.0) common.readout = from_milliseconds(readout_ms_);
  for (const std::string& control : controls_) {
    common.controls.push_back(*control_from(control));
  }
  camera_devices() = std::move(devices_);
}

}  // namespace bevloc::drivers
