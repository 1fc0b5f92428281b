#include "drivers/camera/libcamera/controls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/ranges.h>

namespace bevloc::drivers::libcam {
namespace {

bool is_number(libcamera::ControlType type) {
  return type == libcamera::ControlTypeBool || type == libcamera::ControlTypeInteger32 ||
         type == libcamera::ControlTypeInteger64 || type == libcamera::ControlTypeFloat;
}

/// Converts a number, which is in the range of the control, to the control's type.
libcamera::ControlValue control_value(libcamera::ControlType type, double value) {
  switch (type) {
    case libcamera::ControlTypeBool:
      return libcamera::ControlValue(value != 0.0);
    case libcamera::ControlTypeInteger32:
      return libcamera::ControlValue(static_cast<int32_t>(value));
    case libcamera::ControlTypeInteger64:
      return libcamera::ControlValue(static_cast<int64_t>(value));
    default:
      return libcamera::ControlValue(static_cast<float>(value));
  }
}

/// Returns the value of a numeric control, or NaN for other types.
double number_in(const libcamera::ControlValue& value) {
  switch (value.type()) {
    case libcamera::ControlTypeBool:
      return value.get<bool>() ? 1.0 : 0.0;
    case libcamera::ControlTypeInteger32:
      return value.get<int32_t>();
    case libcamera::ControlTypeInteger64:
      return static_cast<double>(value.get<int64_t>());
    case libcamera::ControlTypeFloat:
      return value.get<float>();
    default:
      return NAN;
  }
}

Status set_control(const libcamera::Camera& camera, const ControlSetting& setting,
                   libcamera::ControlList& list) {
  std::vector<std::string> names;
  for (const auto& [id, info] : camera.controls()) {
    names.push_back(id->name());
    if (id->name() != setting.name) continue;
    if (is_list(*id)) return fail("control {} is a list, which cannot be set here", setting.name);
    if (!is_number(id->type())) return fail("control {} is not a number", setting.name);
    const bool is_whole =
        id->type() == libcamera::ControlTypeFloat || std::floor(setting.value) == setting.value;
    const bool is_in_range =
        setting.value >= number_in(info.min()) && setting.value <= number_in(info.max());
    if (!is_whole || !is_in_range) {
      return fail("control {} is {}, wanted {}, {} to {}", setting.name, setting.value,
                  id->type() == libcamera::ControlTypeFloat ? "a number" : "a whole number",
                  info.min().toString(), info.max().toString());
    }
    list.set(id->id(), control_value(id->type(), setting.value));
    return {};
  }
  return fail("has no control {}; it has {}", setting.name,
              names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")));
}

}  // namespace

bool is_known_list(std::string_view control) {
  constexpr std::array<std::string_view, 5> kLists = {"AfWindows", "ColourCorrectionMatrix",
                                                      "ColourGains", "FrameDurationLimits",
                                                      "SensorBlackLevels"};
  return std::ranges::find(kLists, control) != kLists.end();
}

Result<libcamera::ControlList> start_controls(const libcamera::Camera& camera,
                                              const DeviceCameraConfig& config) {
  libcamera::ControlList list(camera.controls());
  for (const ControlSetting& setting : config.controls) {
    if (Status set = set_control(camera, setting, list); !set) return tl::unexpected(set.error());
  }
  const bool knows_duration =
      camera.controls().find(&libcamera::controls::FrameDurationLimits) != camera.controls().end();
  if (config.rate_hz > 0.0 && knows_duration) {
    constexpr double kMicrosecondsPerSecond = 1e6;
    const auto duration_us =
        static_cast<int64_t>(std::llround(kMicrosecondsPerSecond / config.rate_hz));
    const std::array<int64_t, 2> limits{duration_us, duration_us};
    list.set(libcamera::controls::FrameDurationLimits, libcamera::Span<const int64_t, 2>(limits));
  }
  return list;
}

}  // namespace bevloc::drivers::libcam
