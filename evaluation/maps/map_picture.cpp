#include "evaluation/maps/map_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "common/picture_file.h"
#include "evaluation/drive/drawing.h"
#include "pipeline/map/class_names.h"

namespace bevloc::evaluation {
namespace {

constexpr int kMargin_px = 30;
constexpr int kHead_px = 64;
constexpr int kFoot_px = 44;
constexpr int kSubpixelBits = 4;

const cv::Scalar kLaneColor(200, 200, 170);
const cv::Scalar kCommonColor(190, 190, 190);
const cv::Scalar kFirstColor(40, 40, 220);
const cv::Scalar kSecondColor(60, 160, 0);

/// A sheet with a frame for the map: north is up.
class MapSheet {
 public:
  MapSheet(const Eigen::Vector2d& low, const Eigen::Vector2d& high, int size_px)
      : image_(size_px, size_px, CV_8UC3, kPaper), size_px_(size_px) {
    const Eigen::Vector2d extent = (high - low).cwiseMax(Eigen::Vector2d::Constant(1.0));
    const double width_px = size_px - 2.0 * kMargin_px;
    const double height_px = size_px - kHead_px - kFoot_px - 2.0 * kMargin_px;
    px_per_m_ = std::min(width_px / extent.x(), height_px / extent.y());
    middle_ = 0.5 * (low + high);
    middle_px_ = {0.5 * size_px, kHead_px + kMargin_px + 0.5 * height_px};
  }

  void line(const std::vector<Eigen::Vector2d>& points, const cv::Scalar& color, int width_px,
            bool closed = false) {
    std::vector<cv::Point> pixels;
    for (const Eigen::Vector2d& point : points) {
      const double factor = 1 << kSubpixelBits;
      const double x = middle_px_.x() + px_per_m_ * (point.x() - middle_.x());
      const double y = middle_px_.y() - px_per_m_ * (point.y() - middle_.y());
      pixels.emplace_back(static_cast<int>(std::lround(x * factor)),
                          static_cast<int>(std::lround(y * factor)));
    }
    cv::polylines(image_, pixels, closed, color, width_px, cv::LINE_AA, kSubpixelBits);
  }

  /// Lines are thin on a map of kilometres, where wide lines would cover each other.
  int line_width_px() const { return px_per_m_ < 1.0 ? 1 : 2; }

  void title(const std::string& text) { write_text(image_, text, {kMargin_px, 26}, 0.6); }

  /// Adds an entry to the legend, from the left to the right.
  void legend(const std::string& text, const cv::Scalar& color) {
    const int y = 50;
    cv::line(image_, {legend_px_, y - 5}, {legend_px_ + 22, y - 5}, color, 3, cv::LINE_AA);
    write_text(image_, text, {legend_px_ + 28, y}, 0.45);
    int unused = 0;
    legend_px_ += 46 + cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.45, 1, &unused).width;
  }

  /// A bar of 1, 2 or 5 times a power of ten metres, about a sixth of the sheet wide.
  void scale_bar() {
    const double wanted_m = size_px_ / 6.0 / px_per_m_;
    const double power = std::pow(10.0, std::floor(std::log10(wanted_m)));
    const double digits = wanted_m / power;
    const double length_m = power * (digits >= 5.0 ? 5.0 : digits >= 2.0 ? 2.0 : 1.0);
    const int y = size_px_ - 22;
    const int right = kMargin_px + static_cast<int>(std::lround(length_m * px_per_m_));
    cv::line(image_, {kMargin_px, y}, {right, y}, kInk, 2);
    for (const int x : {kMargin_px, right}) cv::line(image_, {x, y - 6}, {x, y + 6}, kInk, 2);
    write_text(image_, fmt::format("{:g} m", length_m), {right + 10, y + 5}, 0.5);
    const int north = size_px_ - kMargin_px;
    cv::arrowedLine(image_, {north, y + 8}, {north, y - 16}, kInk, 2, cv::LINE_AA, 0, 0.35);
    write_text(image_, "N", {north - 22, y + 2}, 0.5);
  }

  Status write(const std::string& path) const { return write_picture(image_, path); }

 private:
  cv::Mat image_;
  int size_px_;
  double px_per_m_ = 1.0;
  Eigen::Vector2d middle_;
  Eigen::Vector2d middle_px_;
  int legend_px_ = kMargin_px;
};

}  // namespace

Status write_map_picture(const HdMap& map, int size_px, const std::string& path) {
  const MapFacts facts = facts_of(map);
  MapSheet sheet(facts.low, facts.high, size_px);
  for (const Lane& lane : map.lanes) sheet.line(lane.centerline, kLaneColor, 1);
  for (const MapElement& element : map.elements) {
    sheet.line(element.points, class_color(element.element_class), sheet.line_width_px(),
               is_ring(element.element_class));
  }
  sheet.title(fmt::format("{}, origin {}", map.name, text_of(map.origin, 5)));
  for (size_t c = 0; c < kElementClasses; ++c) {
    const auto element_class = static_cast<ElementClass>(c);
    sheet.legend(fmt::format("{}: {}, {:.0f} m", name_of(element_class), facts.classes[c].elements,
                             facts.classes[c].length_m),
                 class_color(element_class));
  }
  sheet.legend(fmt::format("lane: {}", facts.lanes), kLaneColor);
  sheet.scale_bar();
  return sheet.write(path);
}

Status write_diff_picture(const MapDiff& diff, int size_px, const std::string& path) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Eigen::Vector2d low(kFar, kFar);
  Eigen::Vector2d high = -low;
  for (const MapDiff::Piece& piece : diff.pieces) {
    low = low.cwiseMin(piece.from).cwiseMin(piece.to);
    high = high.cwiseMax(piece.from).cwiseMax(piece.to);
  }
  MapSheet sheet(low, high, size_px);
  using In = MapDiff::Piece::In;
  for (const auto& [in, color] : {std::pair<In, cv::Scalar>{In::kBoth, kCommonColor},
                                  {In::kOnlyFirst, kFirstColor},
                                  {In::kOnlySecond, kSecondColor}}) {
    for (const MapDiff::Piece& piece : diff.pieces) {
      if (piece.in == in) sheet.line({piece.from, piece.to}, color, in == In::kBoth ? 1 : 2);
    }
  }
  sheet.title("differences of two maps");
  sheet.legend("in both", kCommonColor);
  sheet.legend("only in the first", kFirstColor);
  sheet.legend("only in the second", kSecondColor);
  sheet.scale_bar();
  return sheet.write(path);
}

}  // namespace bevloc::evaluation
