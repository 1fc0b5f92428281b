// Decodes MJPEG frames to planar YUV.
#pragma once

#include <cstdint>
#include <memory>

#include "common/image_view.h"
#include "common/result.h"
#include "pipeline/preprocessing/format_remap.h"

namespace bevloc {

/// Decodes into its own buffer, which the constructor allocates; the buffer is not resident until
/// the first frame. remap_yuv() converts the colours and upsamples the chroma. libjpeg-turbo
/// allocates and frees a little memory for each image. Not thread safe.
class MjpegDecoder {
 public:
  MjpegDecoder(int width_px, int height_px);
  ~MjpegDecoder();
  MjpegDecoder(MjpegDecoder&&) noexcept;
  MjpegDecoder& operator=(MjpegDecoder&&) = delete;

  /// The result is valid until the next call. Fails unless `jpeg` is a complete colour JPEG (4:4:4,
  /// 4:2:2, 4:2:0 or 4:4:0) of the right size.
  Result<YuvLayout> decode(const ImageView& jpeg);

 private:
  struct Handle;

  int width_px_;
  int height_px_;
  std::unique_ptr<Handle> handle_;
  std::unique_ptr<uint8_t[]> planes_;
};

}  // namespace bevloc
