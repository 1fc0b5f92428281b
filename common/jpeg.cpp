#include "common/jpeg.h"

#include <algorithm>
#include <cassert>

#include <turbojpeg.h>

namespace bevloc {
namespace {

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

uint8_t clamped(double value) {
  return static_cast<uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
}

/// Converts one pixel as ITU-R BT.601-7 or BT.709-6 demands.
void store_rgb(const Yuv& pixel, const YuvEncoding& encoding, uint8_t* rgb) {
  const bool bt709 = encoding.matrix == YuvMatrix::kBt709;
  const double kr = bt709 ? 0.2126 : 0.299;
  const double kb = bt709 ? 0.0722 : 0.114;
  const double luma_scale = encoding.full_range ? 1.0 : 255.0 / 219.0;
  const double chroma_scale = encoding.full_range ? 1.0 : 255.0 / 224.0;
  const double y = luma_scale * (pixel.y - (encoding.full_range ? 0 : 16));
  const double red = 2.0 * (1.0 - kr) * chroma_scale * (pixel.v - 128);
  const double blue = 2.0 * (1.0 - kb) * chroma_scale * (pixel.u - 128);
  rgb[0] = clamped(y + red);
  rgb[1] = clamped(y - (kr * red + kb * blue) / (1.0 - kr - kb));
  rgb[2] = clamped(y + blue);
}

}  // namespace

struct JpegEncoder::Handle {
  tjhandle compressor = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): TurboJPEG's type
  Handle() = default;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    tjFree(bytes);
    tjDestroy(compressor);
  }
};

JpegEncoder::JpegEncoder() : handle_(std::make_unique<Handle>()) {}
JpegEncoder::~JpegEncoder() = default;

bool can_encode_jpeg(PixelFormat format) {
  return format == PixelFormat::kRgb24 || format == PixelFormat::kYuyv ||
         format == PixelFormat::kUyvy || format == PixelFormat::kNv12;
}

void convert_to_rgb(const ImageView& image, RgbImage& rgb) {
  assert(rgb.width == image.width && rgb.height == image.height);
  for (int row = 0; row < image.height; ++row) {
    uint8_t* pixel = rgb.row(row);
    for (int column = 0; column < image.width; ++column, pixel += 3) {
      store_rgb(yuv_at(image, row, column), image.yuv, pixel);
    }
  }
}

Result<std::string_view> JpegEncoder::encode(const ImageView& image, int quality) {
  if (!can_encode_jpeg(image.format)) {
    return fail("image: found the format {}, wanted rgb24, yuyv, uyvy or nv12 to make a JPEG of",
                to_string(image.format));
  }
  RgbView source{image.planes[0].data, image.width, image.height, image.planes[0].stride_bytes};
  if (image.format != PixelFormat::kRgb24) {
    if (rgb_.width != image.width || rgb_.height != image.height) {
      rgb_ = RgbImage::uninitialized(image.width, image.height);
    }
    convert_to_rgb(image, rgb_);
    source = rgb_.view();
  }
  if (tjCompress2(handle_->compressor, source.data, source.width,
                  static_cast<int>(source.stride_bytes), source.height, TJPF_RGB, &handle_->bytes,
                  &handle_->size, TJSAMP_420, quality, 0) != 0) {
    return fail("image: cannot make a JPEG ({})", tjGetErrorStr2(handle_->compressor));
  }
  return std::string_view(reinterpret_cast<const char*>(handle_->bytes), handle_->size);
}

Result<RgbImage> decode_jpeg(std::string_view bytes, std::string_view place) {
  const std::unique_ptr<void, int (*)(tjhandle)> decompressor(tjInitDecompress(), tjDestroy);
  const auto* const data = reinterpret_cast<const uint8_t*>(bytes.data());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  const auto damaged = [&] {
    return fail("{}: found a damaged JPEG ({}), wanted a whole one", place,
                tjGetErrorStr2(decompressor.get()));
  };
  if (tjDecompressHeader3(decompressor.get(), data, bytes.size(), &width, &height, &subsampling,
                          &colours) != 0) {
    return damaged();
  }
  constexpr int kMostPixels = 1 << 26;
  if (width <= 0 || height <= 0 || width > kMostPixels / height) {
    return fail("{}: found a JPEG of {}x{} pixels, wanted less", place, width, height);
  }
  RgbImage image = RgbImage::uninitialized(width, height);
  if (tjDecompress2(decompressor.get(), data, bytes.size(), image.pixels.data(), width, 0, height,
                    TJPF_RGB, 0) != 0) {
    return damaged();
  }
  return image;
}

}  // namespace bevloc
