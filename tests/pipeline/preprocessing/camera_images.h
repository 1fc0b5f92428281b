// Converts an RGB image to each camera format.
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

/// An image in a camera format. Owns the bytes of its view.
struct CameraImage {
  std::vector<uint8_t> bytes;
  ImageView view;
};

inline uint8_t to_byte(double value) {
  return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

/// Y, U and V of a colour, by the definition in ITU-R BT.601 and BT.709.
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

/// Mean YUV of `cols` x `rows` pixels; (u, v) is the first.
inline std::array<double, 3> mean_yuv(const RgbImage& image, int u, int v, int cols, int rows,
                                      const YuvEncoding& encoding) {
  std::array<double, 3> mean{};
  for (int i = 0; i < cols * rows; ++i) {
    const uint8_t* pixel = image.row(v + i / cols) + 3 * (u + i % cols);
    for (int c = 0; c < 3; ++c) mean[c] += pixel[c] / static_cast<double>(cols * rows);
  }
  return yuv_of(mean, encoding);
}

/// YUYV or UYVY. Rows are padded, as drivers may do.
inline CameraImage packed_image(const RgbImage& image, PixelFormat format,
                                const YuvEncoding& encoding) {
  const int luma = format == PixelFormat::kUyvy ? 1 : 0;
  const std::ptrdiff_t stride = 2 * image.width + 32;
  CameraImage result;
  result.bytes.assign(static_cast<size_t>(stride) * image.height, 99);
  for (int v = 0; v < image.height; ++v) {
    uint8_t* row = result.bytes.data() + v * stride;
    for (int u = 0; u < image.width; ++u) {
      row[2 * u + luma] = to_byte(mean_yuv(image, u, v, 1, 1, encoding)[0]);
      if (u % 2 != 0) continue;
      const auto shared = mean_yuv(image, u, v, 2, 1, encoding);
      row[2 * u + 1 - luma] = to_byte(shared[1]);
      row[2 * u + 3 - luma] = to_byte(shared[2]);
    }
  }
  result.view = image.view();
  result.view.format = format;
  result.view.planes = {{{result.bytes.data(), stride}, {}}};
  result.view.yuv = encoding;
  return result;
}

inline CameraImage nv12_image(const RgbImage& image, const YuvEncoding& encoding) {
  const std::ptrdiff_t stride = image.width + 16;
  CameraImage result;
  result.bytes.assign(static_cast<size_t>(stride) * image.height * 3 / 2, 99);
  uint8_t* chroma = result.bytes.data() + stride * image.height;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      result.bytes[v * stride + u] = to_byte(mean_yuv(image, u, v, 1, 1, encoding)[0]);
      if (u % 2 != 0 || v % 2 != 0) continue;
      const auto shared = mean_yuv(image, u, v, 2, 2, encoding);
      chroma[v / 2 * stride + u] = to_byte(shared[1]);
      chroma[v / 2 * stride + u + 1] = to_byte(shared[2]);
    }
  }
  result.view = image.view();
  result.view.format = PixelFormat::kNv12;
  result.view.planes = {{{result.bytes.data(), stride}, {chroma, stride}}};
  result.view.yuv = encoding;
  return result;
}

/// `channels` are those of the top left 2 x 2 pixels, row by row.
inline CameraImage bayer_image(const RgbImage& image, PixelFormat format,
                               const std::array<int, 4>& channels) {
  CameraImage result;
  result.bytes.resize(static_cast<size_t>(image.width) * image.height);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      result.bytes[v * image.width + u] = image.row(v)[3 * u + channels[2 * (v % 2) + u % 2]];
    }
  }
  result.view = image.view();
  result.view.format = format;
  result.view.planes = {{{result.bytes.data(), image.width}, {}}};
  return result;
}

inline CameraImage jpeg_image(const RgbImage& image, int subsampling) {
  constexpr int kQuality = 98;
  unsigned char* file = nullptr;
  unsigned long size = 0;
  const tjhandle compressor = tjInitCompress();
  EXPECT_EQ(tjCompress2(compressor, image.pixels.data(), image.width, 0, image.height, TJPF_RGB,
                        &file, &size, subsampling, kQuality, 0),
            0);
  CameraImage result;
  result.bytes.assign(file, file + size);
  tjFree(file);
  tjDestroy(compressor);
  result.view = image.view();
  result.view.format = PixelFormat::kMjpeg;
  result.view.planes = {{{result.bytes.data(), 0}, {}}};
  result.view.bytes_used = result.bytes.size();
  return result;
}

}  // namespace bevloc::test
