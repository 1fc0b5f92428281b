// Plots on a sheet: frames with ticks, curves, marks and text.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "common/result.h"
#include "firmware/drawing.h"

namespace bevloc::evaluation {

inline const cv::Scalar kGrid(225, 225, 225);
inline const cv::Scalar kGreen(60, 150, 50);
inline const cv::Scalar kOrange(10, 125, 240);
inline const cv::Scalar kBlue(205, 95, 20);

/// Where an axis begins and ends; the end may be the lesser.
struct Interval {
  double from = 0.0;
  double to = 1.0;
};

/// write_text(), centred on a point of the base line.
void write_centered(cv::Mat& sheet, const std::string& text, cv::Point middle, double scale = 0.6);

/// A line in a colour and what it means. Returns where the next one can begin.
cv::Point write_legend(cv::Mat& sheet, const std::string& text, cv::Point left,
                       const cv::Scalar& color);

/// Copies a picture to a place of the sheet, with a frame around it.
void put_picture(cv::Mat& sheet, const cv::Mat& picture, const cv::Rect& place, int interpolation);

Status write_png(const cv::Mat& sheet, const std::string& path);

/// A round number, by which a width is cut into at most `most` pieces.
double tick_step(double width, int most);

/// A rectangle of the sheet with coordinates.
class Plot {
 public:
  /// Clears the place.
  Plot(cv::Mat& sheet, const cv::Rect& place, const Interval& x, const Interval& y);

  /// Ticks at the multiples of a step, with numbers below or on the left.
  void mark_x(double step, const std::string& label = "");
  void mark_y(double step, const Interval& range);
  void draw_frame();

  void curve(const std::vector<cv::Point2d>& points, const cv::Scalar& color, int thickness = 2);
  void dot(cv::Point2d point, const cv::Scalar& color);
  void vertical(double x, const cv::Scalar& color, int thickness = 1);
  void horizontal(double y, const cv::Scalar& color, int thickness = 1);

 private:
  /// In parts of a pixel, so that curves are smooth.
  cv::Point fine_pixel(cv::Point2d point) const;
  cv::Point pixel(cv::Point2d point) const;

  cv::Mat& sheet_;
  cv::Rect place_;
  Interval x_;
  Interval y_;
};

}  // namespace bevloc::evaluation
