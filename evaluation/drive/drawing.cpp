#include "evaluation/drive/drawing.h"

#include <opencv2/imgproc.hpp>

namespace bevloc::evaluation {

cv::Scalar class_color(ElementClass element_class) {
  switch (element_class) {
    case ElementClass::kLaneDivider:
      return {255, 80, 0};
    case ElementClass::kPedestrianCrossing:
      return {0, 200, 0};
    case ElementClass::kRoadBoundary:
      return {0, 0, 255};
  }
  return {0, 0, 0};
}

void write_text(cv::Mat& sheet, const std::string& text, cv::Point left, double scale,
                const cv::Scalar& color) {
  cv::putText(sheet, text, left, cv::FONT_HERSHEY_SIMPLEX, scale, color, 1, cv::LINE_AA);
}

}  // namespace bevloc::evaluation
