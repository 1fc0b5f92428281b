// JPEG files from a camera to the YUV that they are made of.
#pragma once

#include <cstdint>
#include <memory>

#include "common/image_view.h"
#include "common/result.h"
#include "pipeline/preprocessing/format_remap.h"

namespace bevloc {

/// Decodes into memory of its own, made by the constructor; untouched, it costs nothing. The colour
/// conversion and the upsampling of chroma are left to remap_yuv(). libjpeg-turbo itself takes and
/// gives back a little memory for each picture. Not thread safe.
class MjpegDecoder {
 public:
  MjpegDecoder(int width_px, int height_px);
  ~MjpegDecoder();
  MjpegDecoder(MjpegDecoder&&) noexcept;
  MjpegDecoder& operator=(MjpegDecoder&&) = delete;

  /// Valid until the next call. Fails for what is no whole JPEG picture of the right size in colour
  /// (4:4:4, 4:2:2, 4:2:0 or 4:4:0).
  Result<YuvLayout> decode(const ImageView& jpeg);

 private:
  struct Handle;

  int width_px_;
  int height_px_;
  std::unique_ptr<Handle> handle_;
  std::unique_ptr<uint8_t[]> planes_;
};

}  // namespace bevloc
