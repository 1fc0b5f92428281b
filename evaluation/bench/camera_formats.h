// Converts rendered images to the pixel formats that cameras deliver.
#pragma once

#include <array>
#include <vector>

#include "common/image_view.h"
#include "common/result.h"
#include "evaluation/bench/scene.h"

namespace bevloc::bench {

/// An image with the memory that its view refers to.
struct ConvertedImage {
  std::vector<uint8_t> bytes;
  ImageView view;
};
using ConvertedImages = std::array<ConvertedImage, kCameraCount>;

/// The target formats: one of each kind that the image path has separate code for.
inline constexpr std::array kBenchFormats{PixelFormat::kYuyv, PixelFormat::kUyvy,
                                          PixelFormat::kNv12, PixelFormat::kBayerRggb,
                                          PixelFormat::kMjpeg};

/// Converts to one of kBenchFormats. YUV is BT.601 with limited range; JPEG is 4:2:2 with quality
/// 90, as in webcams. Width and height must be even. Fails if libjpeg-turbo does.
Result<ConvertedImage> convert(const RgbImage& image, PixelFormat format);

/// Converts six images. Fails if a width or height is odd, or if libjpeg-turbo fails.
Result<ConvertedImages> convert(const FramesetImages& images, PixelFormat format);

/// Mean number of bytes of one pixel in memory. For JPEG: after decoding.
double bytes_per_pixel(PixelFormat format);

}  // namespace bevloc::bench
