#include "firmware/live/picture.h"

#include <algorithm>
#include <array>

#include <turbojpeg.h>

#include "pipeline/preprocessing/format_remap.h"
#include "pipeline/preprocessing/yuv_colour.h"

namespace bevloc::firmware {
namespace {

constexpr int kQuality = 72;

int reduction_for(int width_px) {
  return (width_px + PictureMaker::kMaxWidth_px - 1) / PictureMaker::kMaxWidth_px;
}

using Rgb = std::array<uint8_t, 3>;

Rgb rgb_of_yuv(int y, int u, int v, const RgbFromYuv& colour) {
  const int luma = colour.luma * (y - (colour.black >> RgbFromYuv::kSampleBits));
  const auto channel = [](int value) {
    return static_cast<uint8_t>(std::clamp(value >> RgbFromYuv::kCoefficientBits, 0, 255));
  };
  u -= 128;
  v -= 128;
  return {channel(luma + colour.red_v * v), channel(luma - colour.green_u * u - colour.green_v * v),
          channel(luma + colour.blue_u * u)};
}

/// Returns the colour of the 2 x 2 pixels at (col, row), which together have all colours.
Rgb rgb_of_bayer(const ImageView& image, int col, int row) {
  const RedPixel red = red_of(image.format);
  const int left = std::min(col, image.width - 2) & ~1;
  const int top = std::min(row, image.height - 2) & ~1;
  const auto at = [&](int r, int c) {
    return image.planes[0].data[(top + r) * image.planes[0].stride_bytes + left + c];
  };
  const int green = at(red.row, 1 - red.col) + at(1 - red.row, red.col);
  return {at(red.row, red.col), static_cast<uint8_t>(green / 2), at(1 - red.row, 1 - red.col)};
}

Rgb pixel_of(const ImageView& image, int col, int row, const RgbFromYuv& colour) {
  const uint8_t* const line = image.planes[0].data + row * image.planes[0].stride_bytes;
  switch (image.format) {
    case PixelFormat::kRgb24:
      return {line[3 * col], line[3 * col + 1], line[3 * col + 2]};
    case PixelFormat::kYuyv:
    case PixelFormat::kUyvy: {
      const uint8_t* const pair = line + 4 * (col / 2);
      const int luma = image.format == PixelFormat::kYuyv ? 0 : 1;
      return rgb_of_yuv(pair[luma + 2 * (col % 2)], pair[1 - luma], pair[3 - luma], colour);
    }
    case PixelFormat::kNv12: {
      const ImagePlane& chroma = image.planes[1];
      const uint8_t* const pair = chroma.data + (row / 2) * chroma.stride_bytes + 2 * (col / 2);
      return rgb_of_yuv(line[col], pair[0], pair[1], colour);
    }
    default:
      return rgb_of_bayer(image, col, row);
  }
}

}  // namespace

struct PictureMaker::Codec {
  tjhandle compressor = tjInitCompress();
  tjhandle decompressor = tjInitDecompress();
  unsigned char* file = nullptr;  ///< the library enlarges it
  unsigned long bytes = 0;        // NOLINT(google-runtime-int): the type of the library

  ~Codec() {
    tjDestroy(compressor);
    tjDestroy(decompressor);
    tjFree(file);
  }
};

PictureMaker::PictureMaker() : codec_(std::make_unique<Codec>()) {}
PictureMaker::~PictureMaker() = default;

Status PictureMaker::read_jpeg(const ImageView& image) {
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  const uint8_t* const file = image.planes[0].data;
  if (tjDecompressHeader3(codec_->decompressor, file, image.bytes_used, &width, &height,
                          &subsampling, &colours) != 0 ||
      width != image.width || height != image.height) {
    return fail("live: found a damaged JPEG, wanted one of {} x {} pixels", image.width,
                image.height);
  }
  // The decoder reduces by 1, 2, 4 or 8.
  int reduction = 1;
  while (reduction < 8 && width / reduction > kMaxWidth_px) reduction *= 2;
  small_ = RgbImage::uninitialized((width + reduction - 1) / reduction,
                                   (height + reduction - 1) / reduction);
  if (tjDecompress2(codec_->decompressor, file, image.bytes_used, small_.row(0), small_.width, 0,
                    small_.height, TJPF_RGB, TJFLAG_FASTDCT) != 0) {
    return fail("live: found a damaged JPEG ({})", tjGetErrorStr2(codec_->decompressor));
  }
  return {};
}

Status PictureMaker::read(const ImageView& image) {
  if (image.width < 2 || image.height < 2) {
    return fail("live: found an image of {} x {} pixels, wanted at least 2 x 2", image.width,
                image.height);
  }
  if (image.format == PixelFormat::kMjpeg) return read_jpeg(image);
  const int reduction = reduction_for(image.width);
  const RgbFromYuv colour = rgb_from_yuv(image.yuv);
  small_ = RgbImage::uninitialized(image.width / reduction, image.height / reduction);
  for (int row = 0; row < small_.height; ++row) {
    uint8_t* out = small_.row(row);
    for (int col = 0; col < small_.width; ++col) {
      out = std::ranges::copy(pixel_of(image, col * reduction, row * reduction, colour), out).out;
    }
  }
  return {};
}

Result<std::string> PictureMaker::jpeg_of(const ImageView& image) {
  if (const Status status = read(image); !status) return tl::unexpected(status.error());
  if (tjCompress2(codec_->compressor, small_.row(0), small_.width, 0, small_.height, TJPF_RGB,
                  &codec_->file, &codec_->bytes, TJSAMP_420, kQuality, TJFLAG_FASTDCT) != 0) {
    return fail("live: no JPEG of an image ({})", tjGetErrorStr2(codec_->compressor));
  }
  return std::string(reinterpret_cast<const char*>(codec_->file), codec_->bytes);
}

}  // namespace bevloc::firmware
