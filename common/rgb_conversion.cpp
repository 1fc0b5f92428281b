#include "common/rgb_conversion.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace bevloc {
namespace {

using Rgb = std::array<uint8_t, 3>;

struct Yuv {
  int y = 0;
  int u = 0;
  int v = 0;
};

Yuv yuv_at(const ImageView& image, int row, int column) {
  const ImagePlane& luma = image.planes[0];
  if (image.format == PixelFormat::kNv12) {
    const ImagePlane& chroma = image.planes[1];
    const uint8_t* uv = chroma.data + (row / 2) * chroma.stride_bytes + (column & ~1);
    return {luma.data[row * luma.stride_bytes + column], uv[0], uv[1]};
  }
  const uint8_t* pair = luma.data + row * luma.stride_bytes + 4 * (column / 2);
  const int second = 2 * (column & 1);
  if (image.format == PixelFormat::kYuyv) return {pair[second], pair[1], pair[3]};
  return {pair[1 + second], pair[0], pair[2]};
}

/// The conversion of ITU-R BT.601-7 or BT.709-6.
class YuvConversion {
 public:
  explicit YuvConversion(const YuvEncoding& encoding)
      : red_part_(encoding.matrix == YuvMatrix::kBt709 ? 0.2126 : 0.299),
        blue_part_(encoding.matrix == YuvMatrix::kBt709 ? 0.0722 : 0.114),
        black_(encoding.full_range ? 0 : 16),
        luma_scale_(encoding.full_range ? 1.0 : 255.0 / 219.0) {
    const double chroma_scale = encoding.full_range ? 1.0 : 255.0 / 224.0;
    red_scale_ = 2.0 * (1.0 - red_part_) * chroma_scale;
    blue_scale_ = 2.0 * (1.0 - blue_part_) * chroma_scale;
  }

  Rgb rgb_of(const Yuv& pixel) const {
    const double y = luma_scale_ * (pixel.y - black_);
    const double red = red_scale_ * (pixel.v - 128);
    const double blue = blue_scale_ * (pixel.u - 128);
    const double green = (red_part_ * red + blue_part_ * blue) / (1.0 - red_part_ - blue_part_);
    return {rounded(y + red), rounded(y - green), rounded(y + blue)};
  }

 private:
  static uint8_t rounded(double value) {
    return static_cast<uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
  }

  double red_part_, blue_part_;  ///< the shares of red and blue in the luma
  int black_;
  double luma_scale_;
  double red_scale_ = 0.0, blue_scale_ = 0.0;
};

/// Returns the colour of the 2 x 2 pixels around (row, column), which together have all colours.
Rgb rgb_of_bayer(const ImageView& image, int row, int column) {
  const RedPixel red = red_of(image.format);
  const int top = std::max(0, std::min(row, image.height - 2)) & ~1;
  const int left = std::max(0, std::min(column, image.width - 2)) & ~1;
  const auto at = [&](int below, int beside) {
    const int r = std::min(top + below, image.height - 1);
    const int c = std::min(left + beside, image.width - 1);
    return image.planes[0].data[r * image.planes[0].stride_bytes + c];
  };
  const int green = at(red.row, 1 - red.col) + at(1 - red.row, red.col);
  return {at(red.row, red.col), static_cast<uint8_t>(green / 2), at(1 - red.row, 1 - red.col)};
}

Rgb rgb_at(const ImageView& image, int row, int column, const YuvConversion& conversion) {
  switch (image.format) {
    case PixelFormat::kRgb24: {
      const uint8_t* pixel = image.rgb().row(row) + 3 * column;
      return {pixel[0], pixel[1], pixel[2]};
    }
    case PixelFormat::kYuyv:
    case PixelFormat::kUyvy:
    case PixelFormat::kNv12:
      return conversion.rgb_of(yuv_at(image, row, column));
    default:
      return rgb_of_bayer(image, row, column);
  }
}

}  // namespace

void convert_to_rgb(const ImageView& image, RgbImage& rgb, int step) {
  assert(image.format != PixelFormat::kMjpeg);
  assert(rgb.width == image.width / step && rgb.height == image.height / step);
  const YuvConversion conversion(image.yuv);
  for (int row = 0; row < rgb.height; ++row) {
    uint8_t* out = rgb.row(row);
    for (int column = 0; column < rgb.width; ++column) {
      out = std::ranges::copy(rgb_at(image, row * step, column * step, conversion), out).out;
    }
  }
}

}  // namespace bevloc
