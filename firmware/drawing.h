// What all pictures of bevloc have in common.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "pipeline/map/hd_map.h"

namespace bevloc {

inline const cv::Scalar kPaper(255, 255, 255);
inline const cv::Scalar kInk(40, 40, 40);
inline const cv::Scalar kTruth(40, 40, 220);

/// The paper's colours, in OpenCV's BGR: dividers blue, crossings green, boundaries red.
cv::Scalar class_color(ElementClass element_class);

/// Text of one line; `left` is where it begins, on its base line.
void write_text(cv::Mat& sheet, const std::string& text, cv::Point left, double scale = 0.6,
                const cv::Scalar& color = kInk);

/// How wide write_text() makes it, in pixels.
int text_width(const std::string& text, double scale);

}  // namespace bevloc
