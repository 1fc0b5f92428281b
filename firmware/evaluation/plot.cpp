#include "firmware/evaluation/plot.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace bevloc::evaluation {
namespace {

constexpr double kNumberScale = 0.5;
/// Digits of a pixel's fraction, as OpenCV counts them.
constexpr int kShift = 4;
constexpr int kTickPx = 5;
constexpr int kCompressionLevel = 9;
/// Levels of a colour in a file: the eye wants no more, and the file is half as large.
constexpr int kLevels = 16;
/// Multiples that miss an interval's end by rounding alone still belong to it.
constexpr double kTolerance = 1e-9;

std::string number(double value, double step) {
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - kTolerance)));
  return fmt::format("{:.{}f}", std::abs(value) < 0.5 * step ? 0.0 : value, digits);
}

/// The multiples of a step inside an interval, which may run downwards.
std::vector<double> multiples(double step, const Interval& interval) {
  std::vector<double> values;
  const auto [least, most] = std::minmax(interval.from, interval.to);
  const auto first = static_cast<int>(std::ceil(least / step - kTolerance));
  const auto last = static_cast<int>(std::floor(most / step + kTolerance));
  for (int i = first; i <= last; ++i) values.push_back(i * step);
  return values;
}

}  // namespace

void write_centered(cv::Mat& sheet, const std::string& text, cv::Point middle, double scale) {
  write_text(sheet, text, middle - cv::Point(text_width(text, scale) / 2, 0), scale);
}

cv::Point write_legend(cv::Mat& sheet, const std::string& text, cv::Point left,
                       const cv::Scalar& color) {
  constexpr int kLinePx = 28;
  constexpr int kGapPx = 8;
  constexpr double kScale = 0.6;
  const cv::Point middle = left - cv::Point(0, 6);
  cv::line(sheet, middle, middle + cv::Point(kLinePx, 0), color, 3, cv::LINE_AA);
  write_text(sheet, text, left + cv::Point(kLinePx + kGapPx, 0), kScale);
  return left + cv::Point(kLinePx + text_width(text, kScale) + 4 * kGapPx, 0);
}

void put_picture(cv::Mat& sheet, const cv::Mat& picture, const cv::Rect& place, int interpolation) {
  cv::resize(picture, sheet(place), place.size(), 0.0, 0.0, interpolation);
  cv::rectangle(sheet, place, kInk, 1);
}

Status write_png(const cv::Mat& sheet, const std::string& path) {
  constexpr int kStep = 255 / (kLevels - 1);
  cv::Mat1b levels(1, 256);
  for (int value = 0; value < 256; ++value) {
    levels(value) = static_cast<uint8_t>((value + kStep / 2) / kStep * kStep);
  }
  cv::Mat reduced;
  cv::LUT(sheet, levels, reduced);
  try {
    if (cv::imwrite(path, reduced, {cv::IMWRITE_PNG_COMPRESSION, kCompressionLevel})) return {};
  } catch (const cv::Exception&) {
    // Said below: OpenCV throws for some paths and returns false for others.
  }
  return fail("{}: the picture cannot be written there", path);
}

double tick_step(double width, int most) {
  const double power = std::pow(10.0, std::floor(std::log10(width / most)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (width / (factor * power) <= most) return factor * power;
  }
  return 10.0 * power;
}

Plot::Plot(cv::Mat& sheet, const cv::Rect& place, const Interval& x, const Interval& y)
    : sheet_(sheet), place_(place), x_(x), y_(y) {
  sheet(place).setTo(kPaper);
}

cv::Point Plot::fine_pixel(cv::Point2d point) const {
  const double x = place_.x + (point.x - x_.from) / (x_.to - x_.from) * place_.width;
  const double y = place_.y + (y_.to - point.y) / (y_.to - y_.from) * place_.height;
  return {static_cast<int>(std::lround(x * (1 << kShift))),
          static_cast<int>(std::lround(y * (1 << kShift)))};
}

cv::Point Plot::pixel(cv::Point2d point) const {
  const cv::Point fine = fine_pixel(point);
  return {fine.x >> kShift, fine.y >> kShift};
}

void Plot::mark_x(double step, const std::string& label) {
  for (const double x : multiples(step, x_)) {
    vertical(x, kGrid);
    const cv::Point foot(pixel({x, y_.from}).x, place_.br().y);
    cv::line(sheet_, foot, foot + cv::Point(0, kTickPx), kInk, 1);
    write_centered(sheet_, number(x, step), foot + cv::Point(0, kTickPx + 14), kNumberScale);
  }
  if (label.empty()) return;
  write_centered(sheet_, label, {place_.x + place_.width / 2, place_.br().y + kTickPx + 34}, 0.55);
}

void Plot::mark_y(double step, const Interval& range) {
  for (const double y : multiples(step, range)) {
    horizontal(y, kGrid);
    const cv::Point foot(place_.x, pixel({x_.from, y}).y);
    cv::line(sheet_, foot, foot - cv::Point(kTickPx, 0), kInk, 1);
    const std::string text = number(y, step);
    const int width = text_width(text, kNumberScale);
    write_text(sheet_, text, foot + cv::Point(-kTickPx - 3 - width, 5), kNumberScale);
  }
}

void Plot::draw_frame() {
  cv::rectangle(sheet_, place_, kInk, 1);
}

void Plot::curve(const std::vector<cv::Point2d>& points, const cv::Scalar& color, int thickness) {
  std::vector<cv::Point> fine;
  std::ranges::transform(points, std::back_inserter(fine),
                         [this](cv::Point2d point) { return fine_pixel(point); });
  cv::polylines(sheet_, fine, false, color, thickness, cv::LINE_AA, kShift);
}

void Plot::dot(cv::Point2d point, const cv::Scalar& color) {
  constexpr int kRadiusPx = 4;
  cv::circle(sheet_, fine_pixel(point), kRadiusPx << kShift, color, cv::FILLED, cv::LINE_AA,
             kShift);
}

void Plot::vertical(double x, const cv::Scalar& color, int thickness) {
  cv::line(sheet_, pixel({x, y_.from}), pixel({x, y_.to}), color, thickness);
}

void Plot::horizontal(double y, const cv::Scalar& color, int thickness) {
  cv::line(sheet_, pixel({x_.from, y}), pixel({x_.to, y}), color, thickness);
}

}  // namespace bevloc::evaluation
