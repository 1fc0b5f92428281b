// The box filter of a remap table for each kind of pixel format.
#pragma once

#include <cstdint>

#include "common/image_view.h"
#include "pipeline/preprocessing/remap_table.h"

namespace bevloc {

/// Memory layout of a YUV image. Luma sample (col, row) is y.data[row * stride_bytes + col *
/// y_step]. For chroma, col and row are first shifted right by chroma_shift_x and chroma_shift_y.
struct YuvLayout {
  ImagePlane y;
  ImagePlane u;
  ImagePlane v;
  int y_step = 1;
  int chroma_step = 1;
  int chroma_shift_x = 0;
  int chroma_shift_y = 0;
  YuvEncoding encoding;
};

// Each function writes planes[c][v][u] = value - 128 for all kNetworkPixels, black outside the
// frame. It averages the samples of the camera format and converts the colour once per network
// pixel. It uses the fastest kernel for this CPU (block_kernels.h); the result is the same on every
// CPU.

void remap_rgb(const RgbView& image, const RemapTable& table, int8_t* planes);

/// Pixels that share a chroma sample each use it as it is. The result equals that of a conversion
/// to RGB before the filter, except for colours outside the RGB range.
void remap_yuv(const YuvLayout& image, const RemapTable& table, int8_t* planes);

/// Interpolates red and blue bilinearly between their samples. Interpolates green bilinearly on
/// each of its two lattices and takes the mean. Mirrors the image at its borders.
void remap_bayer(const ImageView& image, const RemapTable& table, int8_t* planes);

// The plain code, without vector kernels, for a range of pixels.

void remap_rgb_plain(const RgbView& image, const RemapTable& table, PixelRange range,
                     int8_t* planes);
void remap_yuv_plain(const YuvLayout& image, const RemapTable& table, PixelRange range,
                     int8_t* planes);
void remap_bayer_plain(const ImageView& image, const RemapTable& table, PixelRange range,
                       int8_t* planes);

}  // namespace bevloc
