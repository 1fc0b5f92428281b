#include "tests/hil/usb_cameras/pictures.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace bevloc::hil {
namespace {

constexpr int kJpegQuality = 95;

Bytes jpeg_from_yuyv(Bytes& yuyv) {
  const cv::Mat raw(kHeightPx, kWidthPx, CV_8UC2, yuyv.data());
  cv::Mat bgr;
  cv::cvtColor(raw, bgr, cv::COLOR_YUV2BGR_YUY2);
  Bytes jpeg;
  cv::imencode(".jpg", bgr, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return jpeg;
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
  return format == PixelFormat::kMjpeg ? jpeg_from_yuyv(yuyv) : std::move(yuyv);
}

}  // namespace bevloc::hil
