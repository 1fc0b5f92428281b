#include "evaluation/localize/perception_score.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace bevloc::evaluation {
namespace {

/// A cell belongs to a line that covers more than half of it.
constexpr uint8_t kHalfCovered = 127;

/// The cells within kPerceivedWithin_m of the cells of a mask.
cv::Mat widened(const cv::Mat& mask) {
  const auto reach = static_cast<int>(std::lround(kPerceivedWithin_m / kRasterGrid.cell_m));
  const cv::Mat disc =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * reach + 1, 2 * reach + 1));
  cv::Mat wide;
  cv::dilate(mask, wide, disc);
  return wide;
}

double share(int part, int whole) {
  return whole > 0 ? static_cast<double>(part) / whole : 0.0;
}

}  // namespace

PerceptionScore score_perception(std::span<const float> logits, std::span<const uint8_t> raster) {
  PerceptionScore scores;
  const auto plane = static_cast<size_t>(kRasterGrid.cells());
  for (size_t channel = 0; channel < scores.size(); ++channel) {
    cv::Mat perceived(kRasterGrid.rows, kRasterGrid.cols, CV_8UC1);
    cv::Mat mapped(kRasterGrid.rows, kRasterGrid.cols, CV_8UC1);
    for (size_t cell = 0; cell < plane; ++cell) {
      const size_t at = channel * plane + cell;
      perceived.data[cell] = logits[at] > 0.0F ? 255 : 0;
      mapped.data[cell] = raster[at] > kHalfCovered ? 255 : 0;
    }
    ClassScore& score = scores[channel];
    score.mapped = cv::countNonZero(mapped);
    score.perceived = cv::countNonZero(perceived);
    score.recall = share(cv::countNonZero(mapped & widened(perceived)), score.mapped);
    score.precision = share(cv::countNonZero(perceived & widened(mapped)), score.perceived);
  }
  return scores;
}

}  // namespace bevloc::evaluation
