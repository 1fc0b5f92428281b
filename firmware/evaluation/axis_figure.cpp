#include "firmware/evaluation/axis_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "firmware/evaluation/bev_picture.h"
#include "firmware/evaluation/plot.h"
#include "pipeline/solver/axis_matching.h"
#include "pipeline/solver/feature_warp.h"

namespace bevloc::evaluation {
namespace {

constexpr int kChannels = 16;
constexpr double kMove_m = 2.0;
const HypothesisGrid kHypotheses{{3.0, 0.2}, {3.0, 0.2}, {radians(2.0), radians(0.2)}};

/// Margins above the highest value.
constexpr double kHeadroom = 4.0;

/// Of sim::MaskFeatures' sixteen: each class blurred by 0.3 m.
struct ShownChannel {
  const char* name;
  int channel;
};
constexpr std::array<ShownChannel, 3> kShown{{{"divider", 0}, {"crossing", 5}, {"boundary", 10}}};

constexpr int kMarginPx = 64;
constexpr int kTopPx = 110;
constexpr int kPictureWidthPx = 200;
constexpr int kPictureHeightPx = 400;
constexpr int kProfilePx = 96;  ///< width of one along x, height of one along y
constexpr int kGapPx = 10;
constexpr int kBlockPx = kPictureWidthPx + static_cast<int>(kShown.size()) * (kProfilePx + kGapPx);
constexpr int kBlockGapPx = 50;
constexpr int kSheetWidthPx = 2 * kMarginPx + kPictureWidthPx + 2 * (kBlockPx + kBlockGapPx);
constexpr int kSheetHeightPx =
    kTopPx + kPictureHeightPx + static_cast<int>(kShown.size()) * (kProfilePx + kGapPx) + 60;

/// Features as solvers read them, and the planes of them that are shown.
struct Side {
  CellFeatures cells;
  CellFeatures raw;
};

Side side_of(const std::vector<float>& features) {
  Side side{standardised_cells(features, kChannels, kHypotheses),
            CellFeatures(kFeatureGrid, kChannels, kHypotheses)};
  side.raw.assign(features);
  return side;
}

CellFeatures moved(const CellFeatures& features, double x_m, double y_m) {
  CellFeatures result(kFeatureGrid, kChannels, kHypotheses);
  const FeatureWarp warped(features, Se2{x_m, y_m, 0.0});
  for (int row = 0; row < kFeatureGrid.rows; ++row) {
    warp(warped.line(row, 0, kFeatureGrid.cols), result.mutable_cell(row, 0));
  }
  return result;
}

cv::Mat3b picture_of(const CellFeatures& raw) {
  std::vector<float> planes;
  for (const ShownChannel& shown : kShown) {
    for (int row = 0; row < kFeatureGrid.rows; ++row) {
      for (int col = 0; col < kFeatureGrid.cols; ++col) {
        planes.push_back(raw.cell(row, col)[shown.channel]);
      }
    }
  }
  return bev_picture(planes, kFeatureGrid);
}

/// One channel inside the border, less its mean.
std::vector<double> profile(std::span<const float> axis_features, int cells, int channel,
                            const AxisMatching& matching) {
  std::vector<double> values;
  for (int i = matching.crop(); i < cells - matching.crop(); ++i) {
    values.push_back(axis_features[static_cast<size_t>(i) * matching.lanes() + channel]);
  }
  double mean = 0.0;
  for (double value : values) mean += value / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
  return values;
}

/// More than holds all values, with room for a name above them.
Interval around(const std::vector<double>& a, const std::vector<double>& b) {
  Interval interval{-0.1, 0.1};
  for (const auto* values : {&a, &b}) {
    interval.from = std::min(interval.from, *std::ranges::min_element(*values));
    interval.to = std::max(interval.to, *std::ranges::max_element(*values));
  }
  const double margin = 0.1 * (interval.to - interval.from);
  return {interval.from - margin, interval.to + kHeadroom * margin};
}

/// Positions upwards, values to the right.
void draw_x_profile(cv::Mat& sheet, const cv::Rect& place, const AxisMatching& matching,
                    const ShownChannel& shown) {
  const auto map = profile(matching.map().x, kFeatureGrid.rows, shown.channel, matching);
  const auto bev = profile(matching.bev().x, kFeatureGrid.rows, shown.channel, matching);
  const double range_m = kFeatureGrid.x_range_m();
  Plot plot(sheet, place, around(map, bev), {-range_m, range_m});
  plot.vertical(0.0, kGrid);
  for (const auto& [values, color] : {std::pair(&map, kInk), std::pair(&bev, kBlue)}) {
    std::vector<cv::Point2d> curve;
    for (size_t i = 0; i < values->size(); ++i) {
      const int row = static_cast<int>(i) + matching.crop();
      curve.emplace_back((*values)[i], kFeatureGrid.x_of_row(row));
    }
    plot.curve(curve, color, values == &map ? 1 : 2);
  }
  plot.draw_frame();
  write_centered(sheet, shown.name, {place.x + place.width / 2, place.y - 8}, 0.5);
}

/// Positions as in the picture above, values upwards.
void draw_y_profile(cv::Mat& sheet, const cv::Rect& place, const AxisMatching& matching,
                    const ShownChannel& shown) {
  const auto map = profile(matching.map().y, kFeatureGrid.cols, shown.channel, matching);
  const auto bev = profile(matching.bev().y, kFeatureGrid.cols, shown.channel, matching);
  const double range_m = kFeatureGrid.y_range_m();
  Plot plot(sheet, place, {range_m, -range_m}, around(map, bev));
  plot.horizontal(0.0, kGrid);
  for (const auto& [values, color] : {std::pair(&map, kInk), std::pair(&bev, kBlue)}) {
    std::vector<cv::Point2d> curve;
    for (size_t i = 0; i < values->size(); ++i) {
      const int col = static_cast<int>(i) + matching.crop();
      curve.emplace_back(kFeatureGrid.y_of_col(col), (*values)[i]);
    }
    plot.curve(curve, color, values == &map ? 1 : 2);
  }
  plot.draw_frame();
  write_text(sheet, shown.name, place.tl() + cv::Point(6, 16), 0.5);
}

void draw_scores(cv::Mat& sheet, const cv::Rect& place, const AxisMatching& matching) {
  std::vector<double> scores(kHypotheses.x_m.count());
  Plot plot(sheet, place, {-3.0, 3.0}, {-0.2, 1.0});
  plot.mark_x(1.0, "hypothesis, m");
  plot.mark_y(0.2, {-0.2, 1.0});
  cv::Point legend(place.x, place.y - 10);
  for (const bool along_x : {true, false}) {
    along_x ? matching.score_x(scores) : matching.score_y(scores);
    std::vector<cv::Point2d> curve;
    for (int i = 0; i < kHypotheses.x_m.count(); ++i) {
      curve.emplace_back(kHypotheses.x_m.value(i), scores[i]);
    }
    const cv::Scalar& color = along_x ? kGreen : kOrange;
    plot.curve(curve, color);
    const auto best = std::ranges::max_element(curve, {}, &cv::Point2d::y);
    plot.dot(*best, color);
    legend = write_legend(sheet, along_x ? "s(x)" : "s(y)", legend, color);
  }
  plot.draw_frame();
}

/// Returns its place.
cv::Rect draw_picture(cv::Mat& sheet, int left, const std::string& caption,
                      const CellFeatures& raw) {
  const cv::Rect place(left, kTopPx, kPictureWidthPx, kPictureHeightPx);
  write_text(sheet, caption, place.tl() - cv::Point(0, 40), 0.65);
  put_picture(sheet, picture_of(raw), place, cv::INTER_NEAREST);
  return place;
}

/// A picture with the axis features on two sides of it, and the scores in the corner.
void draw_block(cv::Mat& sheet, int left, const std::string& caption, const CellFeatures& raw,
                const AxisMatching& matching) {
  const cv::Rect picture = draw_picture(sheet, left, caption, raw);
  cv::Rect along_x(picture.br().x + kGapPx, kTopPx, kProfilePx, kPictureHeightPx);
  cv::Rect along_y(left, picture.br().y + kGapPx, kPictureWidthPx, kProfilePx);
  for (const ShownChannel& shown : kShown) {
    draw_x_profile(sheet, along_x, matching, shown);
    draw_y_profile(sheet, along_y, matching, shown);
    along_x.x += kProfilePx + kGapPx;
    along_y.y += kProfilePx + kGapPx;
  }
  const cv::Rect scores(picture.br().x + 60, picture.br().y + 50, kBlockPx - kPictureWidthPx - 60,
                        along_y.y - kGapPx - picture.br().y - 50);
  draw_scores(sheet, scores, matching);
}

}  // namespace

Status draw_axis_features(const sim::MatchingScene& scene, const std::string& path) {
  const Side map = side_of(features_of(scene.raster_truth, kChannels));
  const Side seen = side_of(features_of(scene.perceived, kChannels));
  cv::Mat sheet(kSheetHeightPx, kSheetWidthPx, CV_8UC3, kPaper);
  const double x_range_m = kFeatureGrid.x_range_m();
  const double y_range_m = kFeatureGrid.y_range_m();
  Plot axes(sheet, {kMarginPx, kTopPx, kPictureWidthPx, kPictureHeightPx}, {y_range_m, -y_range_m},
            {-x_range_m, x_range_m});
  axes.mark_x(15.0, "y, m");
  axes.mark_y(10.0, {-x_range_m, x_range_m});
  const cv::Rect picture = draw_picture(sheet, kMarginPx, "map, at the true pose", map.raw);
  write_text(sheet, "x, m", picture.tl() - cv::Point(48, 14), 0.55);
  cv::Point legend(kMarginPx, 32);
  legend = write_legend(sheet, "axis features of the map", legend, kInk);
  legend = write_legend(sheet, "axis features of what is perceived", legend, kBlue);

  AxisMatching matching(kFeatureGrid, kChannels, kHypotheses);
  matching.set_features(seen.cells, 0.0, map.cells);
  int left = picture.br().x + kBlockGapPx;
  draw_block(sheet, left, "perceived, at the true pose", seen.raw, matching);
  left += kBlockPx + kBlockGapPx;
  matching.set_features(moved(seen.cells, kMove_m, kMove_m), 0.0, map.cells);
  draw_block(sheet, left, "the same, moved by 2 m forward and left",
             moved(seen.raw, kMove_m, kMove_m), matching);
  return write_png(sheet, path);
}

}  // namespace bevloc::evaluation
