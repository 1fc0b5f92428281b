#include "drivers/camera/libcamera/stream_layout.h"

#include <array>
#include <cassert>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/ranges.h>
#include <libcamera/formats.h>

namespace bevloc::drivers::libcam {
namespace {

std::string offered_formats(const libcamera::StreamFormats& formats) {
  std::vector<std::string> offers;
  for (const libcamera::PixelFormat& format : formats.pixelformats()) {
    std::string offer = format.toString();
    for (const libcamera::Size& size : formats.sizes(format)) {
      offer += fmt::format(" {}x{}", size.width, size.height);
    }
    offers.push_back(offer);
  }
  return fmt::format("{}", fmt::join(offers, "; "));
}

/// A number as a control's type wants it; nothing for types that are no numbers.
std::optional<libcamera::ControlValue> control_value(libcamera::ControlType type, double value) {
  switch (type) {
    case libcamera::ControlTypeBool:
      return libcamera::ControlValue(value != 0.0);
    case libcamera::ControlTypeInteger32:
      return libcamera::ControlValue(static_cast<int32_t>(value));
    case libcamera::ControlTypeInteger64:
      return libcamera::ControlValue(static_cast<int64_t>(value));
    case libcamera::ControlTypeFloat:
      return libcamera::ControlValue(static_cast<float>(value));
    default:
      return std::nullopt;
  }
}

/// A number of any type, to compare with.
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
    const auto value = control_value(id->type(), setting.value);
    if (!value) return fail("control {} is not a number", setting.name);
    if (setting.value < number_in(info.min()) || setting.value > number_in(info.max())) {
      return fail("control {} is {}, wanted {} to {}", setting.name, setting.value,
                  info.min().toString(), info.max().toString());
    }
    list.set(id->id(), *value);
    return {};
  }
  return fail("has no control {}; it has {}", setting.name,
              names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")));
}

}  // namespace

libcamera::PixelFormat libcamera_format(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb24:
      return libcamera::formats::BGR888;
    case PixelFormat::kYuyv:
      return libcamera::formats::YUYV;
    case PixelFormat::kUyvy:
      return libcamera::formats::UYVY;
    case PixelFormat::kNv12:
      return libcamera::formats::NV12;
    case PixelFormat::kBayerRggb:
      return libcamera::formats::SRGGB8;
    case PixelFormat::kBayerGrbg:
      return libcamera::formats::SGRBG8;
    case PixelFormat::kBayerGbrg:
      return libcamera::formats::SGBRG8;
    case PixelFormat::kBayerBggr:
      return libcamera::formats::SBGGR8;
    case PixelFormat::kMjpeg:
      return libcamera::formats::MJPEG;
  }
  assert(false);
  return {};
}

YuvEncoding yuv_encoding(const libcamera::StreamConfiguration& stream) {
  if (!stream.colorSpace) return {};
  using libcamera::ColorSpace;
  return {stream.colorSpace->ycbcrEncoding == ColorSpace::YcbcrEncoding::Rec709 ? YuvMatrix::kBt709
                                                                                : YuvMatrix::kBt601,
          stream.colorSpace->range == ColorSpace::Range::Full};
}

Result<PixelFormat> choose_format(libcamera::CameraConfiguration& configuration,
                                  const DeviceCameraConfig& config) {
  libcamera::StreamConfiguration& stream = configuration.at(0);
  const libcamera::StreamFormats offered = stream.formats();
  std::vector<std::string_view> wanted;
  for (const PixelFormat format : config.formats) {
    wanted.push_back(to_string(format));
    const libcamera::PixelFormat pixel_format = libcamera_format(format);
    const libcamera::Size size(static_cast<unsigned>(config.width_px),
                               static_cast<unsigned>(config.height_px));
    stream.pixelFormat = pixel_format;
    stream.size = size;
    stream.bufferCount = static_cast<unsigned>(config.buffers);
    const bool is_valid = configuration.validate() != libcamera::CameraConfiguration::Invalid;
    if (is_valid && stream.pixelFormat == pixel_format && stream.size == size) return format;
  }
  return fail("offers {}; wanted {} {}x{}", offered_formats(offered), fmt::join(wanted, " or "),
              config.width_px, config.height_px);
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
