// Makes a small JPEG of a camera image in any pixel format, for the live page.
#pragma once

#include <memory>
#include <string>

#include "common/image.h"
#include "common/image_view.h"
#include "common/result.h"

namespace bevloc::firmware {

/// Makes the pictures. One thread.
class PictureMaker {
 public:
  /// No picture is wider than this.
  static constexpr int kMaxWidth_px = 640;

  PictureMaker();
  ~PictureMaker();

  /// Returns a JPEG file with every n-th pixel, for the smallest n that makes the picture narrow
  /// enough. Fails for a damaged or empty image.
  Result<std::string> jpeg_of(const ImageView& image);

 private:
  struct Codec;
  Status read(const ImageView& image);
  Status read_jpeg(const ImageView& image);

  std::unique_ptr<Codec> codec_;
  RgbImage small_;
};

}  // namespace bevloc::firmware
