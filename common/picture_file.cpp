#include "common/picture_file.h"

#include <cassert>

#include <opencv2/imgproc.hpp>

#include "common/image_file.h"

namespace bevloc {

Status write_picture(const cv::Mat& bgr, const std::string& path) {
  assert(bgr.type() == CV_8UC3);
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return write_png({rgb.data, rgb.cols, rgb.rows, static_cast<std::ptrdiff_t>(rgb.step)}, path);
}

}  // namespace bevloc
