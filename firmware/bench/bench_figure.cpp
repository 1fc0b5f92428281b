#include "firmware/bench/bench_figure.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "firmware/evaluation/plot.h"

namespace bevloc::bench {
namespace {

using namespace evaluation;

constexpr int kWidthPx = 1000;
constexpr int kRowPx = 34;
constexpr int kNamePx = 190;
constexpr int kTopPx = 76;
constexpr int kBottomPx = 60;
constexpr int kRightPx = 90;

struct Bar {
  std::string name;
  double p50_ms = 0.0;
  double p99_ms = 0.0;
  double ideal_ms = 0.0;
  cv::Scalar color;
};

std::vector<Bar> bars_of(const BenchResult& result) {
  std::vector<Bar> bars;
  for (const StageResult& stage : result.stages) {
    if (!stage.in_frame) continue;
    bars.push_back({stage.name, stage.time.p50_ms, stage.time.p99_ms,
                    1e3 * ideal_s(stage.work, result.peak), kBlue});
  }
  const TimeSummary& whole = result.whole_frame->time;
  bars.push_back({"whole frame", whole.p50_ms, whole.p99_ms, result.sum_of_ideals_ms(), kGreen});
  return bars;
}

void draw_bar(cv::Mat& sheet, const Bar& bar, int row, double px_per_ms) {
  const int middle = kTopPx + row * kRowPx + kRowPx / 2;
  const auto at = [px_per_ms](double ms) {
    return kNamePx + static_cast<int>(std::lround(ms * px_per_ms));
  };
  constexpr int kHalfBarPx = 10;
  write_text(sheet, bar.name, {12, middle + 6});
  cv::rectangle(sheet, {kNamePx, middle - kHalfBarPx}, {at(bar.p50_ms), middle + kHalfBarPx},
                bar.color, cv::FILLED);
  cv::line(sheet, {at(bar.p50_ms), middle}, {at(bar.p99_ms), middle}, kInk, 2);
  if (bar.ideal_ms > 0.0) {
    cv::line(sheet, {at(bar.ideal_ms), middle - kHalfBarPx - 3},
             {at(bar.ideal_ms), middle + kHalfBarPx + 3}, kOrange, 3);
  }
  write_text(sheet, fmt::format("{:.3f}", bar.p50_ms), {at(bar.p99_ms) + 8, middle + 6}, 0.5);
}

}  // namespace

Status draw_bars(const BenchResult& result, const std::string& path) {
  assert(result.whole_frame);
  const std::vector<Bar> bars = bars_of(result);
  double longest_ms = 0.0;
  for (const Bar& bar : bars) longest_ms = std::max({longest_ms, bar.p99_ms, bar.ideal_ms});
  const int rows = static_cast<int>(bars.size());
  cv::Mat sheet(kTopPx + rows * kRowPx + kBottomPx, kWidthPx, CV_8UC3, kPaper);
  const cv::Rect place(kNamePx, kTopPx, kWidthPx - kNamePx - kRightPx, rows * kRowPx);
  Plot plot(sheet, place, {0.0, longest_ms}, {0.0, 1.0});
  plot.mark_x(tick_step(longest_ms, 8), "ms");
  write_text(
      sheet,
      fmt::format("{}, {}, threads: {}", result.model, result.instruction_set, result.threads),
      {12, 28});
  cv::Point left(12, 56);
  left = write_legend(sheet, "median, with its number", left, kBlue);
  left = write_legend(sheet, "to the 99th percentile", left, kInk);
  write_legend(sheet, "ideal", left, kOrange);
  for (int row = 0; row < rows; ++row) {
    draw_bar(sheet, bars[static_cast<size_t>(row)], row, place.width / longest_ms);
  }
  plot.draw_frame();
  return write_png(sheet, path);
}

}  // namespace bevloc::bench
