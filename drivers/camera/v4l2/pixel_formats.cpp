#include "drivers/camera/v4l2/pixel_formats.h"

#include <cassert>

namespace bevloc::drivers::v4l2 {
namespace {

std::string layout_of(const v4l2_pix_format& pixels) {
  return fmt::format("{} {}x{} with {} bytes per row, {}", fourcc_name(pixels.pixelformat),
                     pixels.width, pixels.height, pixels.bytesperline, field_name(pixels.field));
}

}  // namespace

std::string fourcc_name(uint32_t fourcc) {
  std::string name;
  for (int shift = 0; shift < 32; shift += 8) {
    name.push_back(static_cast<char>((fourcc >> shift) & 0x7FU));
  }
  while (name.ends_with(' ')) name.pop_back();
  return name;
}

uint32_t fourcc_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb24:
      return V4L2_PIX_FMT_RGB24;
    case PixelFormat::kYuyv:
      return V4L2_PIX_FMT_YUYV;
    case PixelFormat::kUyvy:
      return V4L2_PIX_FMT_UYVY;
    case PixelFormat::kNv12:
      return V4L2_PIX_FMT_NV12;
    case PixelFormat::kBayerRggb:
      return V4L2_PIX_FMT_SRGGB8;
    case PixelFormat::kBayerGrbg:
      return V4L2_PIX_FMT_SGRBG8;
    case PixelFormat::kBayerGbrg:
      return V4L2_PIX_FMT_SGBRG8;
    case PixelFormat::kBayerBggr:
      return V4L2_PIX_FMT_SBGGR8;
    case PixelFormat::kMjpeg:
      return V4L2_PIX_FMT_MJPEG;
  }
  assert(false);
  return 0;
}

bool is_progressive(uint32_t field) {
  return field == V4L2_FIELD_NONE || field == V4L2_FIELD_ANY;
}

std::string_view field_name(uint32_t field) {
  switch (field) {
    case V4L2_FIELD_ANY:
      return "any";
    case V4L2_FIELD_NONE:
      return "progressive";
    case V4L2_FIELD_TOP:
      return "top fields only";
    case V4L2_FIELD_BOTTOM:
      return "bottom fields only";
    case V4L2_FIELD_INTERLACED:
    case V4L2_FIELD_INTERLACED_TB:
    case V4L2_FIELD_INTERLACED_BT:
      return "interlaced";
    case V4L2_FIELD_SEQ_TB:
    case V4L2_FIELD_SEQ_BT:
      return "one field after the other";
    case V4L2_FIELD_ALTERNATE:
      return "alternating fields";
    default:
      return "unknown";
  }
}

Status check_same_layout(const v4l2_pix_format& negotiated, const v4l2_pix_format& found) {
  const bool is_same = found.pixelformat == negotiated.pixelformat &&
                       found.width == negotiated.width && found.height == negotiated.height &&
                       found.bytesperline == negotiated.bytesperline &&
                       is_progressive(found.field) == is_progressive(negotiated.field);
  if (is_same) return {};
  return fail(
      "found the format {} after the controls were set, wanted {} as negotiated before; state the "
      "found format in the configuration, or remove the control that changes it",
      layout_of(found), layout_of(negotiated));
}

YuvEncoding yuv_encoding(const v4l2_pix_format& pixels) {
  uint32_t encoding = pixels.ycbcr_enc;
  if (encoding == V4L2_YCBCR_ENC_DEFAULT) {
    encoding = V4L2_MAP_YCBCR_ENC_DEFAULT(pixels.colorspace);
  }
  uint32_t range = pixels.quantization;
  if (range == V4L2_QUANTIZATION_DEFAULT) {
    constexpr bool kIsRgb = false;
    range = V4L2_MAP_QUANTIZATION_DEFAULT(kIsRgb, pixels.colorspace, encoding);
  }
  const bool is_709 = encoding == V4L2_YCBCR_ENC_709 || encoding == V4L2_YCBCR_ENC_XV709;
  return {is_709 ? YuvMatrix::kBt709 : YuvMatrix::kBt601, range == V4L2_QUANTIZATION_FULL_RANGE};
}

ImageView view_of(PixelFormat format, const v4l2_pix_format& pixels, const uint8_t* data) {
  ImageView view;
  view.format = format;
  view.width = static_cast<int>(pixels.width);
  view.height = static_cast<int>(pixels.height);
  view.planes[0] = {data, pixels.bytesperline};
  if (format == PixelFormat::kNv12) {
    // In the single-plane format, the chroma rows directly follow the luma rows, with equal stride.
    const size_t luma = static_cast<size_t>(pixels.bytesperline) * pixels.height;
    view.planes[1] = {data + luma, pixels.bytesperline};
  }
  view.yuv = yuv_encoding(pixels);
  return view;
}

}  // namespace bevloc::drivers::v4l2
