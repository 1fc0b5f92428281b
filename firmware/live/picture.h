// Makes a small JPEG of a camera image in any pixel format, for the live page.
#pragma once

#include <string>

#include "common/image.h"
#include "common/image_view.h"
#include "common/jpeg.h"
#include "common/result.h"

namespace bevloc::firmware {

/// Makes the pictures. One thread.
class PictureMaker {
 public:
  /// No picture is wider than this, except that of an MJPEG image of more than 8 times this width.
  static constexpr int kMaxWidth_px = 640;

  /// Returns a JPEG file with every n-th pixel, for the smallest n that makes the picture narrow
  /// enough. An MJPEG image that is too wide is reduced by 2, 4 or 8 instead, and its pixels are
  /// means. Fails for a damaged or empty image.
  Result<std::string> jpeg_of(const ImageView& image);

 private:
  Status read(const ImageView& image);
  Status read_jpeg(const ImageView& image);

  JpegDecoder decoder_;
  JpegEncoder encoder_;
  RgbImage small_;
};

}  // namespace bevloc::firmware
