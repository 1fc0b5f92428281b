#include "tests/hil/usb_cameras/pictures.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "common/jpeg.h"

namespace bevloc::hil {
namespace {

constexpr int kJpegQuality = 95;

Result<Bytes> jpeg_from_yuyv(const Bytes& yuyv) {
  ImageView image;
  image.format = bevloc::PixelFormat::kYuyv;
  image.width = kWidthPx;
  image.height = kHeightPx;
  image.planes[0] = {reinterpret_cast<const uint8_t*>(yuyv.data()), 2 * kWidthPx};
  image.bytes_used = yuyv.size();
  JpegEncoder encoder;
  const auto jpeg = encoder.encode(image, kJpegQuality);
  if (!jpeg) return tl::unexpected(jpeg.error());
  return Bytes(jpeg->begin(), jpeg->end());
}

}  // namespace

Result<Pictures> Pictures::open(const std::filesystem::path& folder, const std::string& camera) {
  Pictures pictures(folder / camera, 0);
  while (std::filesystem::exists(pictures.folder_ / fmt::format("{}.yuyv", pictures.count_))) {
    ++pictures.count_;
  }
  if (pictures.count_ == 0) {
    return fail("{}: found no image 0.yuyv, wanted the output of drive_pictures",
                pictures.folder_.string());
  }
  return pictures;
}

Result<Bytes> Pictures::read(uint64_t index, PixelFormat format) const {
  const auto file = folder_ / fmt::format("{}.yuyv", std::min(index, count_ - 1));
  std::ifstream stream(file, std::ios::binary);
  Bytes yuyv(kYuyvBytes);
  stream.read(reinterpret_cast<char*>(yuyv.data()), kYuyvBytes);
  if (!stream) return fail("{}: found a short file, wanted {} bytes", file.string(), kYuyvBytes);
  if (format == PixelFormat::kMjpeg) return jpeg_from_yuyv(yuyv);
  return yuyv;
}

}  // namespace bevloc::hil
