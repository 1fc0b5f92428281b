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

/// A decoder that keeps its memory between calls. One thread.
class JpegDecoder {
 public:
  JpegDecoder();

  /// Reads the head of a JPEG file, which must stay valid until the last decode(). Fails if it is
  /// damaged. `place` begins the error messages.
  Status open(std::string_view file, std::string_view place);
  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }

  /// Decodes the open file into `image`, which has its size, or its size divided by 2, 4 or 8 and
  /// rounded up. Fails if the file is damaged or cut off. The pixels are then undefined. Extra
  /// bytes before a marker are no damage.
  Status decode(RgbImage& image);

 private:
  Status damaged() const;

  std::unique_ptr<void, int (*)(void*)> decompressor_;
  std::string_view file_;
  std::string place_;
  int width_px_ = 0;
  int height_px_ = 0;
};

/// Decodes a whole JPEG file. `place` begins the error message.
Result<RgbImage> decode_jpeg(std::string_view bytes, std::string_view place);

}  // namespace bevloc
