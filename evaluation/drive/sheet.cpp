#include "evaluation/drive/sheet.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "common/picture_file.h"
#include "evaluation/drive/drawing.h"
#include "evaluation/drive/error_statistics.h"
#include "evaluation/drive/map_overlay.h"
#include "pipeline/map/rasterizer.h"

namespace bevloc::evaluation {
namespace {

constexpr int kImageWidthPx = 400;
constexpr int kImageHeightPx = 225;
constexpr int kMarginPx = 16;
constexpr int kCaptionPx = 34;
constexpr int kBlockWidthPx = 3 * kImageWidthPx;
constexpr int kBlockHeightPx = 2 * kImageHeightPx;
constexpr int kSheetWidthPx = 2 * kBlockWidthPx + 3 * kMarginPx;
constexpr int kBevHeightPx = 400;
constexpr int kBevWidthPx = 800;
constexpr int kSheetHeightPx = kBlockHeightPx + kBevHeightPx + 2 * kCaptionPx + 3 * kMarginPx;

const cv::Scalar kBar(190, 120, 40);

std::string describe(const char* caption, const std::optional<Se2>& truth, const Se2& pose) {
  if (!truth) return caption;
  const Se2 error = pose_error(*truth, pose);
  return fmt::format("{}: off by {:+.2f} m longitudinal, {:+.2f} m lateral, {:+.2f} deg", caption,
                     error.x_m, error.y_m, degrees(error.yaw_rad));
}

void draw_images(cv::Mat& sheet, cv::Point corner, const SheetContent& content, const Rig& rig,
                 const MapIndex& map, const Se2& pose) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const cv::Rect place(corner.x + (camera % 3) * kImageWidthPx,
                         corner.y + (camera / 3) * kImageHeightPx, kImageWidthPx, kImageHeightPx);
    const RgbImage& image = content.images[camera];
    if (!content.present[camera] || image.pixels.empty()) {
      sheet(place).setTo(cv::Scalar(60, 60, 60));
      continue;
    }
    cv::Mat shown;
    cv::cvtColor(cv::Mat(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.row(0))),
                 shown, cv::COLOR_RGB2BGR);
    const Se2 at_exposure = pose * content.reference_from_exposure[camera];
    draw_map_over_image(map, at_exposure, rig.cameras[camera], shown);
    cv::resize(shown, sheet(place), place.size(), 0, 0, cv::INTER_AREA);
    write_text(sheet, std::string(kCameraNames[camera]), place.tl() + cv::Point(8, 18), 0.45);
  }
}

/// The perceived mask in colour over the map in grey. The vehicle drives to the right.
void draw_bev(cv::Mat& sheet, cv::Point corner, const SheetContent& content, const MapIndex& map) {
  std::vector<uint8_t> raster(kRasterSize);
  MapRasterizer(map).draw(content.corrected, raster);
  cv::Mat bev(kRasterGrid.rows, kRasterGrid.cols, CV_8UC3, kPaper);
  const size_t plane = static_cast<size_t>(kRasterGrid.cells());
  for (int channel = 0; channel < kRasterChannels; ++channel) {
    const cv::Scalar color = class_color(static_cast<ElementClass>(channel));
    for (size_t cell = 0; cell < plane; ++cell) {
      auto& pixel = bev.at<cv::Vec3b>(static_cast<int>(cell));
      const double drawn = raster[channel * plane + cell] / 255.0;
      const double perceived = 1.0 / (1.0 + std::exp(-content.mask_logits[channel * plane + cell]));
      for (int c = 0; c < 3; ++c) {
        const double with_map = pixel[c] * (1.0 - 0.25 * drawn);
        pixel[c] = cv::saturate_cast<uint8_t>(with_map + perceived * (color[c] - with_map));
      }
    }
  }
  cv::Mat turned;
  cv::rotate(bev, turned, cv::ROTATE_90_CLOCKWISE);
  const cv::Rect place(corner.x, corner.y, kBevWidthPx, kBevHeightPx);
  cv::resize(turned, sheet(place), place.size(), 0, 0, cv::INTER_AREA);
  const cv::Point center(corner.x + kBevWidthPx / 2, corner.y + kBevHeightPx / 2);
  cv::rectangle(sheet, center - cv::Point(14, 12), center + cv::Point(52, 12), kInk, 2);
  cv::rectangle(sheet, place, kInk, 1);
}

/// One distribution as bars. The red line is the truth, if it is known.
void draw_distribution(cv::Mat& sheet, cv::Rect place, const std::vector<float>& probability,
                       double range, std::optional<double> truth, const std::string& title) {
  write_text(sheet, title, {place.x, place.y + 18}, 0.5);
  const cv::Rect plot(place.x, place.y + 28, place.width, place.height - 56);
  const float highest = *std::max_element(probability.begin(), probability.end());
  const auto count = static_cast<int>(probability.size());
  const double bar_px = static_cast<double>(plot.width) / count;
  for (int i = 0; i < count; ++i) {
    const auto height = static_cast<int>(probability[i] / std::max(highest, 1e-6F) *
                                         static_cast<float>(plot.height));
    const int left = plot.x + static_cast<int>(i * bar_px) + 1;
    const int right = plot.x + static_cast<int>((i + 1) * bar_px) - 1;
    cv::rectangle(sheet, {left, plot.br().y - height}, {right, plot.br().y}, kBar, cv::FILLED);
  }
  if (truth) {
    const double step = 2.0 * range / (count - 1);
    const auto x = static_cast<int>(plot.x + ((*truth + range) / step + 0.5) * bar_px);
    if (x >= plot.x && x <= plot.br().x) cv::line(sheet, {x, plot.y}, {x, plot.br().y}, kTruth, 2);
  }
  cv::rectangle(sheet, plot, kInk, 1);
  write_text(sheet, fmt::format("{:.1f}", -range), {plot.x, place.br().y - 8}, 0.45);
  write_text(sheet, fmt::format("{:.1f}", range), {plot.br().x - 30, place.br().y - 8}, 0.45);
}

void draw_distributions(cv::Mat& sheet, cv::Rect place, const SheetContent& content) {
  std::optional<Se2> truth;
  if (content.truth) truth = correction_between(content.matched_at, *content.truth);
  const auto on_axis = [&truth](double value) {
    return truth ? std::optional<double>(value) : std::nullopt;
  };
  const Se2 known = truth.value_or(Se2{});
  const int width = (place.width - 2 * kMarginPx) / 3;
  const HypothesisGrid& axes = content.hypotheses;
  draw_distribution(sheet, {place.x, place.y, width, place.height}, content.solution.x_probability,
                    axes.x_m.range, on_axis(known.x_m), "P(x), m longitudinal");
  draw_distribution(sheet, {place.x + width + kMarginPx, place.y, width, place.height},
                    content.solution.y_probability, axes.y_m.range, on_axis(known.y_m),
                    "P(y), m lateral");
  draw_distribution(sheet, {place.x + 2 * (width + kMarginPx), place.y, width, place.height},
                    content.solution.yaw_probability, degrees(axes.yaw_rad.range),
                    on_axis(degrees(known.yaw_rad)), "P(yaw), deg");
}

}  // namespace

Status write_sheet(const SheetContent& content, const Rig& rig, const MapIndex& map,
                   const std::string& path) {
  cv::Mat sheet(kSheetHeightPx, kSheetWidthPx, CV_8UC3, kPaper);
  const cv::Point left(kMarginPx, kMarginPx + kCaptionPx);
  const cv::Point right(2 * kMarginPx + kBlockWidthPx, left.y);
  write_text(sheet, describe("(b) map at the prior", content.truth, content.prior),
             left - cv::Point(0, 10));
  write_text(sheet, describe("(c) map at bevloc's pose", content.truth, content.corrected),
             right - cv::Point(0, 10));
  draw_images(sheet, left, content, rig, map, content.prior);
  draw_images(sheet, right, content, rig, map, content.corrected);

  const int lower = left.y + kBlockHeightPx + kMarginPx + kCaptionPx;
  write_text(sheet, "(a) perceived BEV, driving to the right (in grey the map at bevloc's pose)",
             {kMarginPx, lower - 10});
  draw_bev(sheet, {kMarginPx, lower}, content, map);
  const cv::Rect distributions(2 * kMarginPx + kBevWidthPx, lower,
                               kSheetWidthPx - kBevWidthPx - 3 * kMarginPx, kBevHeightPx);
  write_text(sheet,
             content.truth ? "(d) distributions of the correction (red: truth)"
                           : "(d) distributions of the correction",
             {distributions.x, lower - 10});
  draw_distributions(sheet, distributions, content);

  return write_picture(sheet, path);
}

}  // namespace bevloc::evaluation
