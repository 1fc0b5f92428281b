#include "pipeline/preprocessing/mjpeg_decoder.h"

#include <array>
#include <cassert>

#include <turbojpeg.h>

#include "common/jpeg_warning.h"

namespace bevloc {
namespace {

/// Size that fits any plane. Its rows and columns are rounded up to whole chroma samples.
size_t plane_size(int width_px, int height_px) {
  return static_cast<size_t>(width_px + 1) * static_cast<size_t>(height_px + 1);
}

}  // namespace

struct MjpegDecoder::Handle {
  tjhandle decompressor = tjInitDecompress();
  ~Handle() { tjDestroy(decompressor); }
};

MjpegDecoder::MjpegDecoder(int width_px, int height_px, int reduction)
    : width_px_(width_px),
      height_px_(height_px),
      reduction_(reduction),
      handle_(std::make_unique<Handle>()),
      planes_(std::make_unique_for_overwrite<uint8_t[]>(
          3 * plane_size(reduced(width_px), reduced(height_px)))) {
  assert(reduction == 1 || reduction == 2 || reduction == 4 || reduction == 8);
}

MjpegDecoder::~MjpegDecoder() = default;
MjpegDecoder::MjpegDecoder(MjpegDecoder&&) noexcept = default;

Result<YuvLayout> MjpegDecoder::decode(const ImageView& jpeg) {
  const tjhandle decompressor = handle_->decompressor;
  const uint8_t* data = jpeg.planes[0].data;
  const unsigned long size = jpeg.bytes_used;
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  if (tjDecompressHeader3(decompressor, data, size, &width, &height, &subsampling, &colours) != 0) {
    return fail(
        "JPEG frame: found an unreadable header ({}), wanted a JPEG image; check cable and "
        "bandwidth",
        tjGetErrorStr2(decompressor));
  }
  if (width != width_px_ || height != height_px_) {
    return fail("JPEG frame: found {}x{} pixels, wanted {}x{} as in the calibration", width, height,
                width_px_, height_px_);
  }
  YuvLayout layout;
  layout.encoding.full_range = true;  // as JFIF defines
  layout.chroma_shift_x = subsampling == TJSAMP_422 || subsampling == TJSAMP_420 ? 1 : 0;
  layout.chroma_shift_y = subsampling == TJSAMP_420 || subsampling == TJSAMP_440 ? 1 : 0;
  const bool is_known =
      layout.chroma_shift_x + layout.chroma_shift_y > 0 || subsampling == TJSAMP_444;
  if (colours != TJCS_YCbCr || !is_known) {
    return fail(
        "JPEG frame: found {}, wanted YCbCr 4:4:4, 4:2:2, 4:2:0 or 4:4:0; choose another format "
        "of the camera",
        colours == TJCS_GRAY ? "no colour" : "an unknown colour layout");
  }

  std::array<uint8_t*, 3> planes{};
  std::array<int, 3> strides{};
  const int to_width = reduced_width_px();
  const int to_height = reduced_height_px();
  for (int i = 0; i < 3; ++i) {
    planes[i] = planes_.get() + i * plane_size(to_width, to_height);
    strides[i] = tjPlaneWidth(i, to_width, subsampling);
  }
  // Any other warning counts as an error: it means damaged or truncated data, with the rest of the
  // image grey.
  if (tjDecompressToYUVPlanes(decompressor, data, size, planes.data(), to_width, strides.data(),
                              to_height, 0) != 0 &&
      !is_harmless_warning(decompressor, {reinterpret_cast<const char*>(data), size})) {
    return fail(
        "JPEG frame: found damaged data ({}), wanted a complete JPEG image; check cable and "
        "bandwidth",
        tjGetErrorStr2(decompressor));
  }
  layout.y = {planes[0], strides[0]};
  layout.u = {planes[1], strides[1]};
  layout.v = {planes[2], strides[2]};
  return layout;
}

}  // namespace bevloc
