#include "firmware/evaluation/distribution_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "firmware/evaluation/bev_picture.h"
#include "firmware/evaluation/plot.h"
#include "firmware/evaluation/solver_case.h"

namespace bevloc::evaluation {
namespace {

struct ShownSolver {
  SolverKind kind;
  cv::Scalar color;
};
const std::array<ShownSolver, 3> kShown{{{SolverKind::kFullFft, kGreen},
                                         {SolverKind::kDecoupled, kOrange},
                                         {SolverKind::kDecoupledRefined, kBlue}}};

constexpr int kMarginPx = 30;
constexpr int kTopPx = 96;
constexpr int kPictureWidthPx = 140;
constexpr int kPictureHeightPx = 280;
constexpr int kPlotWidthPx = 390;
constexpr int kPlotGapPx = 66;
constexpr int kRowPx = kPictureHeightPx + 92;
constexpr int kSheetWidthPx = 2 * kMarginPx + kPictureWidthPx + 3 * (kPlotWidthPx + kPlotGapPx);

/// One axis of one solution, in metres or degrees.
struct AxisAnswer {
  std::vector<cv::Point2d> distribution;
  double mean = 0.0;
  double sigma = 0.0;
  cv::Scalar color;
};

using Answers = std::array<std::vector<AxisAnswer>, 3>;  ///< by axis, then by solver

AxisAnswer answer(std::span<const float> probability, const HypothesisAxis& axis, double mean,
                  double variance, double unit, const cv::Scalar& color) {
  AxisAnswer answer{{}, unit * mean, unit * std::sqrt(variance), color};
  for (int i = 0; i < axis.count(); ++i) {
    answer.distribution.emplace_back(unit * axis.value(i), probability[i]);
  }
  return answer;
}

Result<Answers> solve_all(const sim::MatchingScene& scene) {
  Answers answers;
  for (const ShownSolver& shown : kShown) {
    const SolverCase c{.solver = shown.kind};
    const HypothesisGrid axes = c.hypotheses();
    const auto solver = make_solver(c.solver, c.grid, c.channels, axes, hand_made_parameters(c));
    if (!solver) return tl::unexpected(solver.error());
    const auto bev = features_of(scene.perceived, c.channels);
    const auto map = features_of(scene.raster_prior, c.channels);
    SolverResult result;
    (*solver)->solve({bev, c.channels, c.grid}, {map, c.channels, c.grid}, result);
    const Se2& mean = result.correction;
    const Eigen::Vector3d variance = result.covariance.diagonal();
    answers[0].push_back(
        answer(result.x_probability, axes.x_m, mean.x_m, variance.x(), 1.0, shown.color));
    answers[1].push_back(
        answer(result.y_probability, axes.y_m, mean.y_m, variance.y(), 1.0, shown.color));
    answers[2].push_back(answer(result.yaw_probability, axes.yaw_rad, mean.yaw_rad, variance.z(),
                                degrees(1.0), shown.color));
  }
  return answers;
}

/// The means with their deviations stand below the distributions, one under the other.
void draw_axis(cv::Mat& sheet, const cv::Rect& place, const std::vector<AxisAnswer>& answers,
               double truth, const std::string& label) {
  double highest = 0.0;
  for (const AxisAnswer& answer : answers) {
    for (const cv::Point2d& point : answer.distribution) highest = std::max(highest, point.y);
  }
  const double range = answers.front().distribution.back().x;
  Plot plot(sheet, place, {-range, range}, {-0.42 * highest, 1.08 * highest});
  plot.mark_x(0.5 * range, label);
  plot.mark_y(tick_step(highest, 5), {0.0, highest});
  plot.vertical(truth, kTruth, 2);
  double level = 0.0;
  for (const AxisAnswer& answer : answers) {
    plot.curve(answer.distribution, answer.color);
    level -= 0.1 * highest;
    const double from = std::max(answer.mean - answer.sigma, -range);
    const double to = std::min(answer.mean + answer.sigma, range);
    plot.curve({{from, level}, {to, level}}, answer.color);
    plot.dot({answer.mean, level}, answer.color);
  }
  plot.horizontal(0.0, kInk);
  plot.draw_frame();
}

void draw_scene(cv::Mat& sheet, int top, const sim::MatchingScene& scene, const Answers& answers) {
  const cv::Rect picture_place(kMarginPx, top, kPictureWidthPx, kPictureHeightPx);
  cv::Mat3b picture = bev_picture(scene.perceived, kRasterGrid);
  shade(scene.raster_prior, picture);
  put_picture(sheet, picture, picture_place, cv::INTER_AREA);
  std::string road = sim::name(scene.kind);
  std::ranges::replace(road, '_', ' ');
  write_centered(sheet, road, {kMarginPx + kPictureWidthPx / 2, picture_place.br().y + 22}, 0.5);
  const std::array<std::pair<double, const char*>, 3> axes{
      {{scene.correction.x_m, "x, m"},
       {scene.correction.y_m, "y, m"},
       {degrees(scene.correction.yaw_rad), "yaw, degrees"}}};
  int left = picture_place.br().x + kPlotGapPx;
  for (size_t axis = 0; axis < axes.size(); ++axis) {
    draw_axis(sheet, {left, top, kPlotWidthPx, kPictureHeightPx}, answers[axis], axes[axis].first,
              axes[axis].second);
    left += kPlotWidthPx + kPlotGapPx;
  }
}

void draw_heading(cv::Mat& sheet) {
  write_text(sheet,
             "probability of the correction; below, each solver's mean and claimed +-1 sigma; on "
             "the left what is perceived over the map at the prior pose",
             {kMarginPx, 34}, 0.65);
  cv::Point legend(kMarginPx, 68);
  for (const ShownSolver& shown : kShown) {
    legend = write_legend(sheet, std::string(name_of(shown.kind)), legend, shown.color);
  }
  write_legend(sheet, "truth", legend, kTruth);
}

}  // namespace

Status draw_distributions(std::span<const sim::MatchingScene> scenes, const std::string& path) {
  const int height = kTopPx + static_cast<int>(scenes.size()) * kRowPx;
  cv::Mat sheet(height, kSheetWidthPx, CV_8UC3, kPaper);
  draw_heading(sheet);
  int top = kTopPx;
  for (const sim::MatchingScene& scene : scenes) {
    const auto answers = solve_all(scene);
    if (!answers) return tl::unexpected(answers.error());
    draw_scene(sheet, top, scene, *answers);
    top += kRowPx;
  }
  return write_png(sheet, path);
}

}  // namespace bevloc::evaluation
