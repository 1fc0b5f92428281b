// Pictures: PNG and JPEG files of a recording, and the JPEG frames of a camera.
#include <cstring>

#include "common/image_file.h"
#include "pipeline/preprocessing/mjpeg_decoder.h"
#include "tests/fuzz/targets.h"

namespace bevloc::fuzz {
namespace {

// The size of the stored pictures.
constexpr int kWidthPx = 16;
constexpr int kHeightPx = 12;

/// Reads every sample of a plane, so that a sanitizer sees one that lies outside its memory.
uint32_t sum_of(const ImagePlane& plane, int shift_x, int shift_y, int reduction) {
  uint32_t sum = 0;
  for (int row = 0; row < kHeightPx / reduction; ++row) {
    for (int col = 0; col < kWidthPx / reduction; ++col) {
      sum += plane.data[(row >> shift_y) * plane.stride_bytes + (col >> shift_x)];
    }
  }
  return sum;
}

void decode(MjpegDecoder& decoder, Bytes bytes, int reduction) {
  ImageView frame;
  frame.format = PixelFormat::kMjpeg;
  frame.width = kWidthPx;
  frame.height = kHeightPx;
  frame.planes[0].data = bytes.data();
  frame.bytes_used = bytes.size();
  const auto layout = decoder.decode(frame);
  if (!layout) return;
  static volatile uint32_t total = 0;
  total = total + sum_of(layout->y, 0, 0, reduction) +
          sum_of(layout->u, layout->chroma_shift_x, layout->chroma_shift_y, reduction) +
          sum_of(layout->v, layout->chroma_shift_x, layout->chroma_shift_y, reduction);
}

}  // namespace

void run_image_file(Bytes bytes) {
  RgbImage image(kWidthPx, kHeightPx);
  const Status status = read_camera_picture(path_of_file_with(bytes), image);
  if (!status) expect(!status.error().message.empty(), "an error without a message");
}

void run_mjpeg(Bytes bytes) {
  static MjpegDecoder whole(kWidthPx, kHeightPx);
  static MjpegDecoder reduced(kWidthPx, kHeightPx, 2);
  decode(whole, bytes, 1);
  decode(reduced, bytes, 2);
}

}  // namespace bevloc::fuzz
