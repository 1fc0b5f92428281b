// Encodes images as JPEG, and decodes JPEG from memory.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "common/image.h"
#include "common/image_view.h"
#include "common/result.h"

namespace bevloc {

/// An encoder that keeps its memory between calls. One thread.
class JpegEncoder {
 public:
  JpegEncoder();
  ~JpegEncoder();
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;

  /// Encodes rgb24, yuyv, uyvy and nv12 at a quality of 1 to 100. Fails for other formats. The
  /// result is valid until the next call.
  Result<std::string_view> encode(const ImageView& image, int quality);

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
  RgbImage rgb_;
};

/// Whether JpegEncoder encodes images of this format.
bool can_encode_jpeg(PixelFormat format);

/// Converts yuyv, uyvy and nv12 into `rgb`, which has the size of the image.
void convert_to_rgb(const ImageView& image, RgbImage& rgb);

/// Decodes a whole JPEG file. `place` begins the error message.
Result<RgbImage> decode_jpeg(std::string_view bytes, std::string_view place);

}  // namespace bevloc
