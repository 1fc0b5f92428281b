// Writes OpenCV's images as PNG files.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "common/result.h"

namespace bevloc {

/// Creates or replaces the file `path`. `bgr` is CV_8UC3 with blue first, as OpenCV draws.
Status write_picture(const cv::Mat& bgr, const std::string& path);

}  // namespace bevloc
