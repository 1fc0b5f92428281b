// One RGB picture in each format that a camera may deliver it in.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include "common/image_view.h"

namespace bevloc::test {

/// Owns what its view shows.
struct CameraPicture {
  std::vector<uint8_t> bytes;
  ImageView view;
};

inline uint8_t to_byte(double value) {
  return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

/// Y, U and V of a colour, straight from the definition in ITU-R BT.601 and BT.709.
inline std::array<double, 3> yuv_of(const std::array<double, 3>& rgb, const YuvEncoding& encoding) {
  const bool is_601 = encoding.matrix == YuvMatrix::kBt601;
  const double red = is_601 ? 0.299 : 0.2126;
  const double blue = is_601 ? 0.114 : 0.0722;
  const double y = red * rgb[0] + (1.0 - red - blue) * rgb[1] + blue * rgb[2];
  const double u = (rgb[2] - y) / (2.0 * (1.0 - blue));
  const double v = (rgb[0] - y) / (2.0 * (1.0 - red));
  if (encoding.full_range) return {y, u + 128.0, v + 128.0};
  return {16.0 + y * 219.0 / 255.0, 128.0 + u * 224.0 / 255.0, 128.0 + v * 224.0 / 255.0};
}

/// Mean YUV of `cols` x `rows` pixels from (u, v) on.
inline std::array<double, 3> mean_yuv(const RgbImage& image, int u, int v, int cols, int rows,
                                      const YuvEncoding& encoding) {
  std::array<double, 3> mean{};
  for (int i = 0; i < cols * rows; ++i) {
    const uint8_t* pixel = image.row(v + i / cols) + 3 * (u + i % cols);
    for (int c = 0; c < 3; ++c) mean[c] += pixel[c] / static_cast<double>(cols * rows);
  }
  return yuv_of(mean, encoding);
}

/// YUYV, or UYVY when `luma` is 1. Rows are padded, as drivers may do.
inline CameraPicture packed_picture(const RgbImage& image, PixelFormat format,
                                    const YuvEncoding& encoding) {
  const int luma = format == PixelFormat::kUyvy ? 1 : 0;
  const std::ptrdiff_t stride = 2 * image.width + 32;
  CameraPicture picture;
  picture.bytes.assign(static_cast<size_t>(stride) * image.height, 99);
  for (int v = 0; v < image.height; ++v) {
    uint8_t* row = picture.bytes.data() + v * stride;
    for (int u = 0; u < image.width; ++u) {
      row[2 * u + luma] = to_byte(mean_yuv(image, u, v, 1, 1, encoding)[0]);
      if (u % 2 != 0) continue;
      const auto shared = mean_yuv(image, u, v, 2, 1, encoding);
      row[2 * u + 1 - luma] = to_byte(shared[1]);
      row[2 * u + 3 - luma] = to_byte(shared[2]);
    }
  }
  picture.view = image.view();
  picture.view.format = format;
  picture.view.planes = {{{picture.bytes.data(), stride}, {}}};
  picture.view.yuv = encoding;
  return picture;
}

inline CameraPicture nv12_picture(const RgbImage& image, const YuvEncoding& encoding) {
  const std::ptrdiff_t stride = image.width + 16;
  CameraPicture picture;
  picture.bytes.assign(static_cast<size_t>(stride) * image.height * 3 / 2, 99);
  uint8_t* chroma = picture.bytes.data() + stride * image.height;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      picture.bytes[v * stride + u] = to_byte(mean_yuv(image, u, v, 1, 1, encoding)[0]);
      if (u % 2 != 0 || v % 2 != 0) continue;
      const auto shared = mean_yuv(image, u, v, 2, 2, encoding);
      chroma[v / 2 * stride + u] = to_byte(shared[1]);
      chroma[v / 2 * stride + u + 1] = to_byte(shared[2]);
    }
  }
  picture.view = image.view();
  picture.view.format = PixelFormat::kNv12;
  picture.view.planes = {{{picture.bytes.data(), stride}, {chroma, stride}}};
  picture.view.yuv = encoding;
  return picture;
}

/// `channels`: of the top left two by two pixels, row by row.
inline CameraPicture bayer_picture(const RgbImage& image, PixelFormat format,
                                   const std::array<int, 4>& channels) {
  CameraPicture picture;
  picture.bytes.resize(static_cast<size_t>(image.width) * image.height);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      picture.bytes[v * image.width + u] = image.row(v)[3 * u + channels[2 * (v % 2) + u % 2]];
    }
  }
  picture.view = image.view();
  picture.view.format = format;
  picture.view.planes = {{{picture.bytes.data(), image.width}, {}}};
  return picture;
}

inline CameraPicture jpeg_picture(const RgbImage& image, int subsampling) {
  constexpr int kQuality = 98;
  unsigned char* file = nullptr;
  unsigned long size = 0;
  const tjhandle compressor = tjInitCompress();
  EXPECT_EQ(tjCompress2(compressor, image.pixels.data(), image.width, 0, image.height, TJPF_RGB,
                        &file, &size, subsampling, kQuality, 0),
            0);
  CameraPicture picture;
  picture.bytes.assign(file, file + size);
  tjFree(file);
  tjDestroy(compressor);
  picture.view = image.view();
  picture.view.format = PixelFormat::kMjpeg;
  picture.view.planes = {{{picture.bytes.data(), 0}, {}}};
  picture.view.bytes_used = picture.bytes.size();
  return picture;
}

}  // namespace bevloc::test
