#include "firmware/evaluation/spectra_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "firmware/evaluation/bev_picture.h"
#include "firmware/evaluation/plot.h"
#include "pipeline/map/rasterizer.h"
#include "pipeline/solver/amplitude_spectrum.h"
#include "pipeline/solver/yaw_spectrum.h"
#include "sim/perception/matching_scene.h"
#include "sim/vehicle/placement.h"

namespace bevloc::evaluation {
namespace {

constexpr Se2 kTurn{0.0, 0.0, radians(10.0)};
constexpr Se2 kTurnAndShift{5.0, 5.0, radians(10.0)};
/// The masks and their union, which is what is drawn.
constexpr int kChannels = 4;
constexpr int kUnion = 3;
constexpr int kBand = 2;
const cv::Scalar kBandColor(170, 40, 150);
const cv::Scalar kOtherBands(190, 200, 120);
constexpr int kSpectrumSize = 128;
/// The largest hypotheses of the score's plot.
const HypothesisGrid kHypotheses{.yaw_rad = {radians(15.0), radians(0.5)}};

constexpr int kMarginPx = 24;
constexpr int kMaskWidthPx = 192;
constexpr int kSpectrumPx = 3 * kSpectrumSize;
constexpr int kGapPx = 12;
constexpr int kGroupPx = kMaskWidthPx + kGapPx + kSpectrumPx;
constexpr int kSheetWidthPx = 3 * kGroupPx + 4 * kMarginPx;
constexpr int kTopPx = 44;
constexpr int kPlotTopPx = kTopPx + kSpectrumPx + 130;
constexpr int kPlotHeightPx = 250;
constexpr int kSheetHeightPx = kPlotTopPx + kPlotHeightPx + 60;

struct View {
  std::string caption;
  cv::Scalar color;
  std::vector<uint8_t> raster;
  CellFeatures cells;
};

/// The first junction that random driving comes to.
std::optional<Se2> find_junction(const sim::World& world, const MapIndex& index) {
  constexpr int kTries = 1000;
  sim::Random random(sim::seed_for(world.seed, "figure"));
  for (int i = 0; i < kTries; ++i) {
    const Se2 pose = sim::random_pose_on_road(world, random);
    if (sim::road_kind(index, pose) == sim::RoadKind::kJunction) return pose;
  }
  return std::nullopt;
}

/// The map around a pose from which `correction` leads to `map_from_vehicle`.
View view_from(const MapIndex& index, const Se2& map_from_vehicle, const Se2& correction,
               const char* caption, const cv::Scalar& color) {
  std::vector<uint8_t> raster(kRasterSize);
  MapRasterizer(index).draw(map_from_vehicle * correction.inverse(), raster);
  CellFeatures cells = standardised_cells(features_of(raster, kChannels), kChannels, kHypotheses);
  return {caption, color, std::move(raster), std::move(cells)};
}

/// log(1 + amplitude), dark where it is large, frequency zero in the middle.
cv::Mat1b spectrum_picture(const View& view) {
  AmplitudeSpectrum spectrum(kFeatureGrid, kChannels, kSpectrumSize, kSpectrumSize, Window::kHann,
                             kSpectrumSize);
  spectrum.compute(view.cells, view.cells);
  const auto amplitude = spectrum.amplitude(0);
  cv::Mat1f brightness(kSpectrumSize, kSpectrumSize);
  for (int row = 0; row < kSpectrumSize; ++row) {
    for (int col = 0; col < kSpectrumSize; ++col) {
      const int u = row - kSpectrumSize / 2;
      const int v = col - kSpectrumSize / 2;
      // Half of the columns are stored: the others are the point reflection of these.
      const int offset = v < 0 ? spectrum.offset(-u, -v) : spectrum.offset(u, v);
      brightness(row, col) = std::log1p(amplitude[offset + kUnion]);
    }
  }
  double most = 0.0;
  cv::minMaxLoc(brightness, nullptr, &most);
  // The weaker third has no direction: white.
  cv::Mat1b picture;
  brightness.convertTo(picture, CV_8U, -255.0 / (0.67 * most), 255.0 / 0.67);
  return picture;
}

void draw_bands(cv::Mat& sheet, const cv::Rect& place) {
  const cv::Point middle = place.tl() + cv::Point(place.width / 2, place.height / 2);
  constexpr double kPxPerFrequency = kSpectrumPx * kFeatureGrid.cell_m;
  for (int edge = 0; edge <= YawSpectrum::kBands; ++edge) {
    const double frequency =
        YawSpectrum::kMinFrequency +
        edge * (YawSpectrum::kMaxFrequency - YawSpectrum::kMinFrequency) / YawSpectrum::kBands;
    const bool of_band = edge == kBand || edge == kBand + 1;
    cv::circle(sheet, middle, static_cast<int>(std::lround(frequency * kPxPerFrequency)),
               of_band ? kBandColor : kOtherBands, of_band ? 2 : 1, cv::LINE_AA);
  }
}

void draw_view(cv::Mat& sheet, const View& view, int left) {
  write_text(sheet, view.caption, {left, kTopPx - 14}, 0.7);
  const cv::Rect mask(left, kTopPx, kMaskWidthPx, kSpectrumPx);
  put_picture(sheet, bev_picture(view.raster), mask, cv::INTER_AREA);
  const cv::Rect place(mask.br().x + kGapPx, kTopPx, kSpectrumPx, kSpectrumPx);
  cv::Mat3b picture;
  cv::cvtColor(spectrum_picture(view), picture, cv::COLOR_GRAY2BGR);
  put_picture(sheet, picture, place, cv::INTER_NEAREST);
  draw_bands(sheet, place);
  write_centered(sheet, "60 m x 30 m", {mask.x + mask.width / 2, mask.br().y + 22}, 0.55);
  write_centered(sheet, "-0.83 to 0.83 cycles/m, forward up",
                 {place.x + place.width / 2, place.br().y + 22}, 0.55);
}

std::vector<cv::Point2d> signature_curve(std::span<const float> signature, int lanes) {
  std::vector<cv::Point2d> curve;
  for (int i = 0; i < YawSpectrum::kAngles; ++i) {
    curve.emplace_back(180.0 * i / YawSpectrum::kAngles,
                       signature[static_cast<size_t>(i) * lanes + kUnion]);
  }
  return curve;
}

void draw_signatures(cv::Mat& sheet, const std::array<View, 3>& views) {
  constexpr int kWidthPx = kSheetWidthPx * 2 / 3;
  const cv::Rect place(kMarginPx + 30, kPlotTopPx, kWidthPx, kPlotHeightPx);
  const cv::Rect score_place(place.br().x + 90, kPlotTopPx,
                             kSheetWidthPx - kMarginPx - place.br().x - 90, kPlotHeightPx);
  write_text(sheet, "yaw signature of the purple band (standardised amplitude)",
             {place.x, place.y - 40}, 0.7);
  write_text(sheet, "score of the yaw hypotheses, all bands", {score_place.x - 40, place.y - 40},
             0.7);
  Plot signatures(sheet, place, {0.0, 180.0}, {-2.0, 5.0});
  signatures.mark_x(10.0, "direction of the frequency, degrees counter-clockwise from forward");
  signatures.mark_y(1.0, {-2.0, 5.0});
  Plot scores(sheet, score_place, {-15.0, 15.0}, {-2.0, 0.0});
  scores.mark_x(5.0, "hypothesis, degrees");
  scores.mark_y(0.5, {-2.0, 0.0});
  scores.vertical(degrees(kTurn.yaw_rad), kInk);
  cv::Point legend(place.x, place.y - 12);
  YawSpectrum spectrum(kFeatureGrid, kChannels, kHypotheses.yaw_rad);
  std::vector<double> score(kHypotheses.yaw_rad.count());
  for (const View& view : views) {
    spectrum.score(views.front().cells, view.cells, score);
    signatures.curve(signature_curve(spectrum.map_signature(kBand), spectrum.lanes()), view.color);
    std::vector<cv::Point2d> curve;
    for (int k = 0; k < kHypotheses.yaw_rad.count(); ++k) {
      curve.emplace_back(degrees(kHypotheses.yaw_rad.value(k)), score[k]);
    }
    scores.curve(curve, view.color);
    legend = write_legend(sheet, view.caption, legend, view.color);
  }
  signatures.draw_frame();
  scores.draw_frame();
}

}  // namespace

Status draw_spectra(uint64_t town, const std::string& path) {
  const sim::World world = sim::generate_world(sim::kEvaluationSeedBase + town);
  const MapIndex index(world.map);
  const std::optional<Se2> pose = find_junction(world, index);
  if (!pose) return fail("scene {}: its town has no junction to draw", town);
  const std::array<View, 3> views{
      view_from(index, *pose, {}, "(a) map", kInk),
      view_from(index, *pose, kTurn, "(b) turned by 10 deg", kBlue),
      view_from(index, *pose, kTurnAndShift, "(c) turned by 10 deg, moved by 5 m along x and y",
                kOrange)};
  cv::Mat sheet(kSheetHeightPx, kSheetWidthPx, CV_8UC3, kPaper);
  int left = kMarginPx;
  for (const View& view : views) {
    draw_view(sheet, view, left);
    left += kGroupPx + kMarginPx;
  }
  draw_signatures(sheet, views);
  return write_png(sheet, path);
}

}  // namespace bevloc::evaluation
