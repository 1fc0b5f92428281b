#include "pipeline/solver/reference/literal_matcher.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <fmt/format.h>

#include "pipeline/solver/feature_warp.h"
#include "pipeline/solver/grid_limits.h"
#include "pipeline/solver/posterior.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {
namespace {

constexpr int kAngles = 180;
/// GeM raises smaller values to this.
constexpr float kLeast = 1e-6F;

/// Rows and columns from which radii_of() is positive.
constexpr int kLeastSide = 4;

/// Number of radii that are read: 1 ... radii_of(grid) bins.
int radii_of(const BevGrid& grid) {
  return std::min(grid.rows, grid.cols) / 2 - 1;
}

double zncc_of(std::span<const float> a, std::span<const float> b) {
  double sums[5] = {};
  for (size_t i = 0; i < a.size(); ++i) {
    sums[0] += a[i];
    sums[1] += b[i];
    sums[2] += double(a[i]) * a[i];
    sums[3] += double(b[i]) * b[i];
    sums[4] += double(a[i]) * b[i];
  }
  const auto count = static_cast<double>(a.size());
  return zncc(sums[4], moments(sums[0], sums[2], count), moments(sums[1], sums[3], count), count);
}

double best_of(std::span<const float> probability, const HypothesisAxis& axis) {
  const auto best = std::ranges::max_element(probability);
  return axis.value(static_cast<int>(best - probability.begin()));
}

float greatest_magnitude(std::span<const float> values) {
  float greatest = 0.0F;
  for (float value : values) greatest = std::max(greatest, std::abs(value));
  return greatest;
}

}  // namespace

Status LiteralMatcher::check_grid(const BevGrid& grid) {
  if (LanesFft::supports(grid.rows) && LanesFft::supports(grid.cols) && radii_of(grid) > 0) {
    return {};
  }
  return refuse_grid(grid, fmt::format("rows and columns of the form 2^a 5^b, {} to {}", kLeastSide,
                                       kMaxGridSide));
}

LiteralMatcher::LiteralMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                               const SolverParameters& parameters)
    : grid_(grid),
      channels_(channels),
      hypotheses_(hypotheses),
      parameters_(parameters),
      bev_(grid, channels, hypotheses),
      map_(grid, channels, hypotheses),
      moved_{CellFeatures(grid, channels), CellFeatures(grid, channels)},
      spectrum_(grid, channels, grid.rows, grid.cols, Window::kNone, radii_of(grid) + 2.0),
      scaled_(static_cast<size_t>(channels) * grid.cells()),
      map_yaw_(static_cast<size_t>(kAngles) * channels),
      bev_yaw_(map_yaw_.size()),
      map_x_(static_cast<size_t>(grid.rows) * channels),
      map_y_(static_cast<size_t>(grid.cols) * channels),
      bev_x_(map_x_.size()),
      bev_y_(map_y_.size()) {
  for (int i = 0; i < kAngles; ++i) {
    const double angle = i * std::numbers::pi / kAngles;
    for (int radius = 1; radius <= radii_of(grid); ++radius) {
      const double u = radius * std::cos(angle);
      const double v = radius * std::sin(angle);
      taps_.push_back({static_cast<int>(std::floor(u)), static_cast<int>(std::floor(v)),
                       static_cast<float>(u - std::floor(u)),
                       static_cast<float>(v - std::floor(v))});
    }
  }
  scores_.reserve(
      std::max({hypotheses.x_m.count(), hypotheses.y_m.count(), hypotheses.yaw_rad.count()}));
}

void LiteralMatcher::match(const MatchSide& bev, const MatchSide& map, SolverResult& result) {
  // Scaling both sides by the same factor keeps the sums finite and changes no score.
  const float greatest = std::max(greatest_magnitude(bev.raw), greatest_magnitude(map.raw));
  for (const auto& [side, cells] : {std::pair(&bev, &bev_), std::pair(&map, &map_)}) {
    for (size_t i = 0; i < scaled_.size(); ++i) scaled_[i] = side->raw[i] / greatest;
    cells->assign(scaled_);
  }
  axis_features(map_, map_x_, map_y_);
  const double yaw_rad = solve_yaw(result);
  solve_axis(hypotheses_.x_m, yaw_rad, true, parameters_.x_scale, result.x_probability);
  solve_axis(hypotheses_.y_m, yaw_rad, false, parameters_.y_scale, result.y_probability);
  result.correction = {best_of(result.x_probability, hypotheses_.x_m),
                       best_of(result.y_probability, hypotheses_.y_m), yaw_rad};
}

double LiteralMatcher::solve_yaw(SolverResult& result) {
  spectrum_.compute(map_, map_);
  yaw_features(spectrum_.amplitude(0), map_yaw_);
  const int count = hypotheses_.yaw_rad.count();
  scores_.resize(count);
  // Two hypotheses share one transform.
  for (int k = 0; k < count; k += 2) {
    const int next = std::min(k + 1, count - 1);
    move({0.0, 0.0, hypotheses_.yaw_rad.value(k)}, moved_[0]);
    move({0.0, 0.0, hypotheses_.yaw_rad.value(next)}, moved_[1]);
    spectrum_.compute(moved_[0], moved_[1]);
    scores_[k] = yaw_score(0);
    scores_[next] = yaw_score(1);
  }
  softmax(scores_, parameters_.yaw_scale, result.yaw_probability);
  return best_of(result.yaw_probability, hypotheses_.yaw_rad);
}

/// -MSE / mean(Y_M^2) of one side of the spectrum.
double LiteralMatcher::yaw_score(size_t side) {
  yaw_features(spectrum_.amplitude(side), bev_yaw_);
  double difference = 0.0;
  double map_square = 0.0;
  for (size_t i = 0; i < map_yaw_.size(); ++i) {
    difference += double(map_yaw_[i] - bev_yaw_[i]) * (map_yaw_[i] - bev_yaw_[i]);
    map_square += double(map_yaw_[i]) * map_yaw_[i];
  }
  return map_square > 0.0 ? -difference / map_square : 0.0;
}

void LiteralMatcher::solve_axis(const HypothesisAxis& axis, double yaw_rad, bool along_x,
                                double scale, std::vector<float>& probability) {
  scores_.resize(axis.count());
  for (int i = 0; i < axis.count(); ++i) {
    move(along_x ? Se2{axis.value(i), 0.0, yaw_rad} : Se2{0.0, axis.value(i), yaw_rad}, moved_[0]);
    axis_features(moved_[0], bev_x_, bev_y_);
    scores_[i] = along_x ? zncc_of(map_x_, bev_x_) : zncc_of(map_y_, bev_y_);
  }
  softmax(scores_, scale, probability);
}

void LiteralMatcher::move(const Se2& correction, CellFeatures& moved) const {
  warp_all(bev_, correction, moved.mutable_cell(0, 0), moved.row_stride());
}

void LiteralMatcher::yaw_features(std::span<const float> amplitude, std::vector<float>& yaw) const {
  const int radii = radii_of(grid_);
  std::ranges::fill(yaw, 0.0F);
  for (int i = 0; i < kAngles; ++i) {
    for (int radius = 0; radius < radii; ++radius) {
      const PolarTap& tap = taps_[i * radii + radius];
      const float* near_row = amplitude.data() + spectrum_.offset(tap.row, tap.col);
      const float* far_row = amplitude.data() + spectrum_.offset(tap.row + 1, tap.col);
      const int right = spectrum_.lanes();
      for (int c = 0; c < channels_; ++c) {
        const float near_value =
            near_row[c] + tap.col_fraction * (near_row[right + c] - near_row[c]);
        const float far_value = far_row[c] + tap.col_fraction * (far_row[right + c] - far_row[c]);
        yaw[i * channels_ + c] +=
            (near_value + tap.row_fraction * (far_value - near_value)) / static_cast<float>(radii);
      }
    }
  }
}

void LiteralMatcher::axis_features(const CellFeatures& features, std::vector<float>& x,
                                   std::vector<float>& y) const {
  const float omega = parameters_.gem_omega;
  std::ranges::fill(x, 0.0F);
  std::ranges::fill(y, 0.0F);
  for (int row = 0; row < grid_.rows; ++row) {
    for (int col = 0; col < grid_.cols; ++col) {
      const float* cell = features.cell(row, col);
      for (int c = 0; c < channels_; ++c) {
        const float value = std::max(cell[c], kLeast);
        const float power = omega == 1.0F ? value : std::pow(value, omega);
        x[row * channels_ + c] += power / static_cast<float>(grid_.cols);
        y[col * channels_ + c] += power / static_cast<float>(grid_.rows);
      }
    }
  }
  if (omega == 1.0F) return;
  for (std::vector<float>* axis : {&x, &y}) {
    for (float& value : *axis) value = std::pow(value, 1.0F / omega);
  }
}

}  // namespace bevloc
