#include "drivers/camera/v4l2/format_negotiation.h"

#include <cerrno>
#include <cmath>
#include <cstring>

namespace bevloc::drivers::v4l2 {
namespace {

/// The largest relative difference of rates that count as the same, such as 30 Hz and 29.97 Hz.
constexpr double kRateTolerance = 0.01;

bool has_format(const Device& device, uint32_t fourcc) {
  v4l2_fmtdesc description{};
  description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; device.call(VIDIOC_ENUM_FMT, &description) == 0; ++description.index) {
    if (description.pixelformat == fourcc) return true;
  }
  return false;
}

std::string rates_of(const Device& device, uint32_t fourcc, uint32_t width, uint32_t height) {
  std::string text;
  v4l2_frmivalenum interval{};
  interval.pixel_format = fourcc;
  interval.width = width;
  interval.height = height;
  for (; device.call(VIDIOC_ENUM_FRAMEINTERVALS, &interval) == 0; ++interval.index) {
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) return " at a range of rates";
    text += fmt::format("{}{:.4g}", text.empty() ? " at " : ", ",
                        static_cast<double>(interval.discrete.denominator) /
                            static_cast<double>(interval.discrete.numerator));
  }
  return text.empty() ? text : text + " Hz";
}

std::string sizes_of(const Device& device, uint32_t fourcc) {
  std::string text;
  v4l2_frmsizeenum size{};
  size.pixel_format = fourcc;
  for (; device.call(VIDIOC_ENUM_FRAMESIZES, &size) == 0; ++size.index) {
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
      return fmt::format(" {}x{} to {}x{}", size.stepwise.min_width, size.stepwise.min_height,
                         size.stepwise.max_width, size.stepwise.max_height);
    }
    text += fmt::format("{} {}x{}{}", text.empty() ? "" : ",", size.discrete.width,
                        size.discrete.height,
                        rates_of(device, fourcc, size.discrete.width, size.discrete.height));
  }
  return text;
}

/// Sets the frame rate. Returns whether the device accepted it, or true if it has no rates.
bool set_rate(const Device& device, double rate_hz) {
  if (rate_hz <= 0.0) return true;
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (device.call(VIDIOC_G_PARM, &parameters) != 0) return true;
  v4l2_captureparm& capture = parameters.parm.capture;
  if ((capture.capability & V4L2_CAP_TIMEPERFRAME) == 0) return true;
  constexpr uint32_t kUnitsPerSecond = 1'000'000;
  capture.timeperframe = {static_cast<uint32_t>(std::lround(kUnitsPerSecond / rate_hz)),
                          kUnitsPerSecond};
  if (device.call(VIDIOC_S_PARM, &parameters) != 0) return false;
  const double got_hz = static_cast<double>(capture.timeperframe.denominator) /
                        static_cast<double>(capture.timeperframe.numerator);
  return std::abs(got_hz - rate_hz) <= kRateTolerance * rate_hz;
}

}  // namespace

Result<StreamFormat> negotiate_format(const Device& device, const DeviceCameraConfig& config) {
  std::string wanted;
  std::string fields;
  for (const PixelFormat format : config.formats) {
    wanted += fmt::format("{}{}", wanted.empty() ? "" : " or ", to_string(format));
    const uint32_t fourcc = fourcc_of(format);
    if (!has_format(device, fourcc)) continue;
    v4l2_format request{};
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    v4l2_pix_format& pixels = request.fmt.pix;
    pixels.width = static_cast<uint32_t>(config.width_px);
    pixels.height = static_cast<uint32_t>(config.height_px);
    pixels.pixelformat = fourcc;
    pixels.field = V4L2_FIELD_NONE;
    if (const int error = device.call(VIDIOC_S_FMT, &request)) {
      if (error == EBUSY) return fail("{}: another program uses it", device.name());
      return fail("{}: the format cannot be set: {}", device.name(), std::strerror(error));
    }
    if (!is_progressive(pixels.field)) {
      fields = fmt::format(", with the field order \"{}\"", field_name(pixels.field));
      continue;
    }
    const bool is_agreed = pixels.pixelformat == fourcc &&
                           pixels.width == static_cast<uint32_t>(config.width_px) &&
                           pixels.height == static_cast<uint32_t>(config.height_px);
    if (is_agreed && set_rate(device, config.rate_hz)) return StreamFormat{format, pixels};
  }
  return fail("{}: offers {}{}; wanted {}{} {}x{}{}", device.name(), offered_formats(device),
              fields, fields.empty() ? "" : "progressive ", wanted, config.width_px,
              config.height_px,
              config.rate_hz > 0.0 ? fmt::format(" at {:.4g} Hz", config.rate_hz) : "");
}

Status check_kept_format(const Device& device, const StreamFormat& format) {
  v4l2_format current{};
  current.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int error = device.call(VIDIOC_G_FMT, &current)) {
    return fail("{}: the format cannot be read: {}", device.name(), std::strerror(error));
  }
  const Status same = check_same_layout(format.pixels, current.fmt.pix);
  return same ? same : fail("{}: {}", device.name(), same.error().message);
}

std::string offered_formats(const Device& device) {
  std::string text;
  v4l2_fmtdesc description{};
  description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; device.call(VIDIOC_ENUM_FMT, &description) == 0; ++description.index) {
    text += fmt::format("{}{}{}", text.empty() ? "" : "; ", fourcc_name(description.pixelformat),
                        sizes_of(device, description.pixelformat));
  }
  return text.empty() ? "no format" : text;
}

}  // namespace bevloc::drivers::v4l2
