// The box filter of a remap table over pictures of each kind of pixel.
#pragma once

#include <cstdint>

#include "common/image_view.h"
#include "pipeline/preprocessing/remap_table.h"

namespace bevloc {

/// Where the samples of a YUV picture lie. Sample (col, row) of luma is y.data[row * stride + col *
/// y_step]; chroma is the same with both coordinates shifted right first.
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

/// The first red pixel of a Bayer picture: 0 or 1.
struct RedPixel {
  int row;
  int col;
};
RedPixel red_of(PixelFormat format);

// Each writes planes[c][v][u] = value - 128 of all kNetworkPixels; black outside the frame. The
// mean is taken in the picture's own samples; colour is converted once for each network pixel.
// The fastest kernels that this CPU has do it (block_kernels.h), with the same result on each.

void remap_rgb(const RgbView& image, const RemapTable& table, int8_t* planes);

/// Neighbours that share a chroma sample have it each: the same as converting to RGB first, but for
/// the clipping of colours that RGB does not have.
void remap_yuv(const YuvLayout& image, const RemapTable& table, int8_t* planes);

/// Red and blue are interpolated bilinearly between their samples, green likewise on each of its
/// two lattices, whose mean is taken. The borders are mirrored.
void remap_bayer(const ImageView& image, const RemapTable& table, int8_t* planes);

// The same by the plain code, for some of the pixels.

void remap_rgb_plain(const RgbView& image, const RemapTable& table, PixelRange range,
                     int8_t* planes);
void remap_yuv_plain(const YuvLayout& image, const RemapTable& table, PixelRange range,
                     int8_t* planes);
void remap_bayer_plain(const ImageView& image, const RemapTable& table, PixelRange range,
                       int8_t* planes);

}  // namespace bevloc
