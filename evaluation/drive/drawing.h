// Colours and text of the sheet.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {

// All colours are BGR, as OpenCV expects.
inline const cv::Scalar kPaper(255, 255, 255);
inline const cv::Scalar kInk(40, 40, 40);
inline const cv::Scalar kTruth(40, 40, 220);

/// The paper's colours: dividers blue, crossings green, boundaries red.
cv::Scalar class_color(ElementClass element_class);

/// Writes one line of text. `left` is the start of its base line.
void write_text(cv::Mat& sheet, const std::string& text, cv::Point left, double scale = 0.6,
                const cv::Scalar& color = kInk);

}  // namespace bevloc::evaluation
