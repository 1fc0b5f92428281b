#include "sim/perception/corruption.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "pipeline/map/rasterizer.h"
#include "sim/perception/correlated_noise.h"
#include "sim/perception/soft_stroke.h"
#include "sim/random.h"
#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

constexpr double kFarRange_m = 30.0;  ///< the range of the "far" parameters
constexpr double kLineHalfWidth_m = 0.5 * kRasterLineWidthCells * kRasterGrid.cell_m;
constexpr double kSharp_m = 0.5 * kRasterGrid.cell_m;

// Correlation lengths of the errors along a line.
constexpr double kConfidenceLength_m = 8.0;
constexpr double kDisplacementLength_m = 10.0;
constexpr double kWidthLength_m = 6.0;

/// A length that grows linearly with range.
struct Spread {
  double near_m;
  double far_m;

  double at(double range_m) const { return near_m + (far_m - near_m) * range_m / kFarRange_m; }
};

/// The error model of one corruption level. Confidences are log-odds.
struct Perception {
  std::array<double, kRasterChannels> confidence;  ///< per class, at range 0
  double confidence_loss;                          ///< loss from range 0 to kFarRange_m
  double confidence_sigma;                         ///< sigma of the variation along a line
  double occlusion_loss;                           ///< behind an obstacle
  double overlooked;                               ///< chance that an element is missed completely
  Spread along_ray;                                ///< sigma of the displacement in range
  Spread across_ray;                               ///< sigma of the displacement across the ray
  double width_sigma;                              ///< sigma of the logarithm of the line width
  Spread softness;                                 ///< blur of a line's edges
  double false_per_line;                           ///< false lines per real line
  double noise;                                    ///< sigma of a smooth field over the mask
};

constexpr Perception kMild{.confidence = {3.52, 3.74, 3.64},
                           .confidence_loss = 2.0,
                           .confidence_sigma = 1.2,
                           .occlusion_loss = 2.5,
                           .overlooked = 0.02,
                           .along_ray = {0.06, 0.20},
                           .across_ray = {0.04, 0.08},
                           .width_sigma = 0.12,
                           .softness = {0.10, 0.25},
                           .false_per_line = 0.15,
                           .noise = 0.02};
constexpr Perception kPaper{.confidence = {4.10, 4.24, 4.33},
                            .confidence_loss = 2.5,
                            .confidence_sigma = 1.5,
                            .occlusion_loss = 3.0,
                            .overlooked = 0.04,
                            .along_ray = {0.10, 0.40},
                            .across_ray = {0.06, 0.12},
                            .width_sigma = 0.18,
                            .softness = {0.15, 0.40},
                            .false_per_line = 0.3,
                            .noise = 0.03};
constexpr Perception kHard{.confidence = {2.11, 2.32, 2.07},
                           .confidence_loss = 3.0,
                           .confidence_sigma = 1.8,
                           .occlusion_loss = 3.5,
                           .overlooked = 0.12,
                           .along_ray = {0.18, 0.80},
                           .across_ray = {0.10, 0.25},
                           .width_sigma = 0.25,
                           .softness = {0.20, 0.60},
                           .false_per_line = 0.6,
                           .noise = 0.05};

const Perception& perception_at(CorruptionLevel level) {
  if (level == CorruptionLevel::kMild) return kMild;
  return level == CorruptionLevel::kPaper ? kPaper : kHard;
}

/// An object on the ground that hides what is behind it.
struct Obstacle {
  double direction_rad;
  double half_angle_rad;
  double range_m;
};

std::vector<Obstacle> random_obstacles(uint64_t seed) {
  Random random(seed);
  std::vector<Obstacle> obstacles(static_cast<size_t>(random.integer(2, 6)));
  for (Obstacle& obstacle : obstacles) {
    obstacle.direction_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
    obstacle.range_m = random.uniform(4.0, 25.0);
    obstacle.half_angle_rad = std::atan(0.5 * random.uniform(1.8, 4.5) / obstacle.range_m);
  }
  return obstacles;
}

/// How far a point is hidden: 0 in plain view, 1 behind an obstacle.
double hidden(const std::vector<Obstacle>& obstacles, const Eigen::Vector2d& point) {
  constexpr double kEdge_rad = radians(2.0);
  constexpr double kDepth_m = 2.0;
  const double range_m = point.norm();
  const double direction_rad = std::atan2(point.y(), point.x());
  double most = 0.0;
  for (const Obstacle& obstacle : obstacles) {
    const double off_rad = std::abs(wrap_angle(direction_rad - obstacle.direction_rad));
    const double within =
        1.0 - smooth_step(obstacle.half_angle_rad, obstacle.half_angle_rad + kEdge_rad, off_rad);
    const double behind = smooth_step(obstacle.range_m, obstacle.range_m + kDepth_m, range_m);
    most = std::max(most, within * behind);
  }
  return most;
}

double probability(double log_odds) {
  return 1.0 / (1.0 + std::exp(-log_odds));
}

std::vector<StrokePoint> sharp_stroke(const VisibleLine& line) {
  std::vector<StrokePoint> stroke;
  for (const Eigen::Vector2d& point : line.points) {
    stroke.push_back({.position_m = point,
                      .half_width_m = kLineHalfWidth_m,
                      .strength = 1.0,
                      .softness_m = kSharp_m});
  }
  return stroke;
}

/// Draws the painted stretches of a line.
void draw_painted(const std::vector<StrokePoint>& stroke, const std::vector<bool>& painted,
                  std::span<float> cells) {
  for (const PointRange& stretch : painted_stretches(painted)) {
    draw_stroke(std::span(stroke).subspan(stretch.first, stretch.last - stretch.first + 1), cells);
  }
}

/// Perceives lines, each with its own errors. The dashes of a line share its errors, so
/// neighbouring dashes are displaced alike.
class LineObserver {
 public:
  LineObserver(const Perception& perception, std::vector<Obstacle> obstacles)
      : perception_(perception), obstacles_(std::move(obstacles)) {}

  /// `confidence` is the log-odds that a point at range 0 in plain view is seen.
  std::vector<StrokePoint> observe(const std::vector<Eigen::Vector2d>& line, double confidence,
                                   uint64_t seed) const {
    const CorrelatedNoise confidence_noise(seed_for(seed, "confidence"), kConfidenceLength_m);
    const CorrelatedNoise along_noise(seed_for(seed, "along ray"), kDisplacementLength_m);
    const CorrelatedNoise across_noise(seed_for(seed, "across ray"), kDisplacementLength_m);
    const CorrelatedNoise width_noise(seed_for(seed, "width"), kWidthLength_m);
    std::vector<StrokePoint> stroke;
    double station_m = 0.0;
    for (size_t i = 0; i < line.size(); ++i) {
      if (i > 0) station_m += (line[i] - line[i - 1]).norm();
      const double range_m = line[i].norm();
      const Eigen::Vector2d ray = line[i] / std::max(range_m, 1e-6);
      const double log_odds = confidence - perception_.confidence_loss * range_m / kFarRange_m -
                              perception_.occlusion_loss * hidden(obstacles_, line[i]) +
                              perception_.confidence_sigma * confidence_noise.at(station_m);
      const double along_m = perception_.along_ray.at(range_m) * along_noise.at(station_m);
      const double across_m = perception_.across_ray.at(range_m) * across_noise.at(station_m);
      stroke.push_back({.position_m = line[i] + along_m * ray + across_m * left_of(ray),
                        .half_width_m = kLineHalfWidth_m * std::exp(perception_.width_sigma *
                                                                    width_noise.at(station_m)),
                        .strength = probability(log_odds),
                        .softness_m = perception_.softness.at(range_m)});
    }
    return stroke;
  }

 private:
  const Perception& perception_;
  std::vector<Obstacle> obstacles_;
};

/// A perceived line that does not exist.
struct FalseLine {
  ElementClass element_class;
  std::vector<Eigen::Vector2d> points;
  std::vector<bool> painted;  ///< as in VisibleLine
};

/// A copy of a stretch of a line, moved sideways, as a tar joint, shadow or sidewalk edge would
/// appear. The copy of a dashed line may be dashed too, with dashes from another place of the line,
/// like old paint.
FalseLine beside(const VisibleLine& line, Random& random) {
  const Path path(line.points);
  const double length_m = std::min(random.uniform(5.0, 20.0), path.length_m());
  const double from_m = random.uniform(0.0, path.length_m() - length_m);
  const double model_m = random.uniform(0.0, path.length_m() - length_m);
  const double right_m = random.uniform(0.9, 3.0) * (random.chance(0.5) ? 1.0 : -1.0);
  FalseLine copy{line.element_class, {}, {}};
  if (random.chance(0.3)) copy.element_class = static_cast<ElementClass>(random.integer(0, 2));
  const bool dashed = random.chance(0.5) && copy.element_class == ElementClass::kLaneDivider;
  double station_m = 0.0;
  for (size_t i = 0; i < line.points.size(); ++i) {
    if (i > 0) station_m += (line.points[i] - line.points[i - 1]).norm();
    if (station_m < model_m || station_m > model_m + length_m) continue;
    if (!copy.points.empty()) copy.painted.push_back(!dashed || line.painted[i - 1]);
    copy.points.push_back(path.beside(from_m + station_m - model_m, right_m));
  }
  return copy;
}

/// A straight line at a random place.
FalseLine anywhere(Random& random) {
  const double length_m = random.uniform(3.0, 10.0);
  const Eigen::Vector2d along = unit_vector(random.uniform(0.0, 2.0 * std::numbers::pi));
  const double y_m = random.uniform(-1.0, 1.0) * kRasterGrid.y_range_m();
  const double x_m = random.uniform(-1.0, 1.0) * kRasterGrid.x_range_m();
  const Eigen::Vector2d middle(x_m, y_m);
  FalseLine line{static_cast<ElementClass>(random.integer(0, 2)), {}, {}};
  const int pieces = static_cast<int>(length_m) + 1;
  for (int k = 0; k <= pieces; ++k) {
    line.points.emplace_back(middle + (static_cast<double>(k) / pieces - 0.5) * length_m * along);
  }
  line.painted.assign(static_cast<size_t>(pieces), true);
  return line;
}

void add_noise(double sigma, uint64_t seed, std::span<float> mask) {
  constexpr int kCells = 8;
  const size_t plane = kRasterGrid.cells();
  for (int channel = 0; channel < kRasterChannels; ++channel) {
    cv::Mat1f cells(kRasterGrid.rows, kRasterGrid.cols, mask.data() + channel * plane);
    cells += sigma * smooth_field(mix_seed(seed) + static_cast<uint64_t>(channel), cells.rows,
                                  cells.cols, kCells);
  }
  for (float& value : mask) value = std::clamp(value, 0.0F, 1.0F);
}

std::span<float> cells_of(ElementClass element_class, std::span<float> mask) {
  const size_t plane = kRasterGrid.cells();
  return mask.subspan(static_cast<size_t>(element_class) * plane, plane);
}

/// Draws the real lines. Whole elements are overlooked: a crossing with both edges, a dashed line
/// with all its dashes.
void draw_true_lines(const std::vector<VisibleLine>& lines, const Perception& perception,
                     const LineObserver& observer, uint64_t seed, std::span<float> mask) {
  for (size_t i = 0; i < lines.size(); ++i) {
    const VisibleLine& line = lines[i];
    Random of_element(seed_for(seed, "element") + line.element);
    if (of_element.chance(perception.overlooked)) continue;
    const double confidence = perception.confidence[static_cast<size_t>(line.element_class)];
    draw_painted(observer.observe(line.points, confidence, mix_seed(seed_for(seed, "line") + i)),
                 line.painted, cells_of(line.element_class, mask));
  }
}

void draw_false_lines(const std::vector<VisibleLine>& lines, const Perception& perception,
                      const LineObserver& observer, uint64_t seed, std::span<float> mask) {
  for (size_t i = 0; i < lines.size(); ++i) {
    Random random(mix_seed(seed_for(seed, "false line") + i));
    if (!random.chance(perception.false_per_line)) continue;
    const bool parallel = random.chance(0.7) && polyline_length(lines[i].points) > 3.0;
    const FalseLine line = parallel ? beside(lines[i], random) : anywhere(random);
    const double confidence = random.uniform(0.5, 3.0);
    draw_painted(observer.observe(line.points, confidence, random.bits()), line.painted,
                 cells_of(line.element_class, mask));
  }
}

}  // namespace

const char* name(CorruptionLevel level) {
  constexpr std::array<const char*, kCorruptionLevels> kNames{"clean", "mild", "paper", "hard"};
  return kNames[static_cast<size_t>(level)];
}

void draw_perceived(const std::vector<VisibleLine>& lines, CorruptionLevel level, uint64_t seed,
                    std::span<float> mask) {
  assert(mask.size() == kRasterSize);
  std::fill(mask.begin(), mask.end(), 0.0F);
  if (level == CorruptionLevel::kClean) {
    for (const VisibleLine& line : lines) {
      draw_painted(sharp_stroke(line), line.painted, cells_of(line.element_class, mask));
    }
    return;
  }
  const Perception& perception = perception_at(level);
  const LineObserver observer(perception, random_obstacles(seed_for(seed, "obstacles")));
  draw_true_lines(lines, perception, observer, seed, mask);
  draw_false_lines(lines, perception, observer, seed, mask);
  add_noise(perception.noise, seed_for(seed, "noise"), mask);
}

}  // namespace bevloc::sim
