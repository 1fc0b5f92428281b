// Decodes MJPEG frames to planar YUV.
#pragma once

#include <cstdint>
#include <memory>

#include "common/image_view.h"
#include "common/result.h"
#include "pipeline/preprocessing/format_remap.h"

namespace bevloc {

/// Decodes into its own buffer, which the constructor allocates; the buffer is not resident until
/// the first frame. A reduction makes the images smaller while they are decoded, which saves most
/// of the inverse transform: a pixel is then the mean of reduction x reduction pixels. remap_yuv()
/// converts the colours and upsamples the chroma. libjpeg-turbo allocates and frees a little memory
/// for each image. One thread.
class MjpegDecoder {
 public:
  /// The size is that of the JPEG images; `reduction` is 1, 2, 4 or 8.
  MjpegDecoder(int width_px, int height_px, int reduction = 1);
  ~MjpegDecoder();
  MjpegDecoder(MjpegDecoder&&) noexcept;
  MjpegDecoder& operator=(MjpegDecoder&&) = delete;

  /// Size of the decoded images.
  int reduced_width_px() const { return reduced(width_px_); }
  int reduced_height_px() const { return reduced(height_px_); }

  /// The result is valid until the next call. Fails unless `jpeg` is a complete colour JPEG (4:4:4,
  /// 4:2:2, 4:2:0 or 4:4:0) of the right size. Extra bytes before a marker are no damage.
  Result<YuvLayout> decode(const ImageView& jpeg);

 private:
  struct Handle;
  int reduced(int length_px) const { return (length_px + reduction_ - 1) / reduction_; }

  int width_px_;
  int height_px_;
  int reduction_;
  std::unique_ptr<Handle> handle_;
  std::unique_ptr<uint8_t[]> planes_;
};

}  // namespace bevloc
