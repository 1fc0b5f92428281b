// Pictures as cameras of other kinds would deliver them.
#pragma once

#include <array>
#include <vector>

#include "common/image_view.h"
#include "common/result.h"
#include "firmware/bench/scene.h"

namespace bevloc::bench {

/// Owns what its view shows.
struct CameraPicture {
  std::vector<uint8_t> bytes;
  ImageView view;
};
using CameraPictures = std::array<CameraPicture, kCameraCount>;

/// What the bench converts to: one format of each kind that the image path has code for.
inline constexpr std::array kBenchFormats{PixelFormat::kYuyv, PixelFormat::kUyvy,
                                          PixelFormat::kNv12, PixelFormat::kBayerRggb,
                                          PixelFormat::kMjpeg};

/// One of kBenchFormats; YUV is BT.601 in limited range, JPEG is 4:2:2 at quality 90, as webcams
/// have it. The image has even sides. Fails where libjpeg-turbo does.
Result<CameraPicture> convert(const RgbImage& image, PixelFormat format);

Result<CameraPictures> convert(const Pictures& pictures, PixelFormat format);

/// Bytes of one pixel of a picture in memory, decoded where it is a JPEG.
double bytes_per_pixel(PixelFormat format);

}  // namespace bevloc::bench
