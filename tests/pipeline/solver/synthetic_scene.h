// Analytic scenes, which can be sampled from any pose without interpolation.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "common/se2.h"
#include "pipeline/bev_grid.h"
#include "pipeline/solver/feature_view.h"
#include "tests/support/cell_places.h"

namespace bevloc {

/// Each channel is a sum of Gaussian bumps on a map around the origin.
class SyntheticScene {
 public:
  struct Bump {
    int channel;
    double x_m, y_m;
    double x_sigma_m, y_sigma_m;
    double height;
  };

  explicit SyntheticScene(int channels) : channels_(channels) {}

  void add(const Bump& bump) { bumps_.push_back(bump); }

  /// Features on `grid` around a vehicle at `map_from_vehicle`, [channels, rows, cols].
  std::vector<float> seen_from(const Se2& map_from_vehicle, const BevGrid& grid) const {
    std::vector<float> features(static_cast<size_t>(channels_) * grid.cells());
    const std::vector<Eigen::Vector2d> points = points_of(map_from_vehicle, grid);
    for (const Bump& bump : bumps_) {
      float* channel = features.data() + static_cast<size_t>(bump.channel) * grid.cells();
      for (size_t cell = 0; cell < points.size(); ++cell) {
        channel[cell] += static_cast<float>(height_at(points[cell], bump));
      }
    }
    return features;
  }

  /// Random bumps, which constrain every direction. No default hypothesis moves one across the
  /// border of the grid.
  static SyntheticScene structured(int channels, unsigned seed) {
    SyntheticScene scene(channels);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> x(-26.0, 26.0);
    std::uniform_real_distribution<double> y(-11.0, 11.0);
    std::uniform_real_distribution<double> sigma(0.7, 1.4);
    std::uniform_real_distribution<double> height(0.5, 1.5);
    for (int channel = 0; channel < channels; ++channel) {
      for (int i = 0; i < 40; ++i) {
        scene.add({channel, x(random), y(random), sigma(random), sigma(random), height(random)});
      }
    }
    return scene;
  }

  /// Endless solid lines along x, which do not constrain x.
  static SyntheticScene straight_road(int channels, unsigned seed) {
    SyntheticScene scene(channels);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> y(-14.0, 14.0);
    for (int channel = 0; channel < channels; ++channel) {
      for (int i = 0; i < 3; ++i) scene.add({channel, 0.0, y(random), 1e6, 0.8, 1.0});
    }
    return scene;
  }

 private:
  /// The cells of `grid` on the map, row by row.
  static std::vector<Eigen::Vector2d> points_of(const Se2& map_from_vehicle, const BevGrid& grid) {
    std::vector<Eigen::Vector2d> points;
    points.reserve(grid.cells());
    for (int cell = 0; cell < grid.cells(); ++cell) {
      points.push_back(map_from_vehicle * test::place_of(grid, cell));
    }
    return points;
  }

  static double height_at(const Eigen::Vector2d& point, const Bump& bump) {
    constexpr double kNegligible = 30.0;  // exp(-30) is 1e-13; exp() would take most of the time
    const double dx = (point.x() - bump.x_m) / bump.x_sigma_m;
    const double dy = (point.y() - bump.y_m) / bump.y_sigma_m;
    const double exponent = 0.5 * (dx * dx + dy * dy);
    return exponent < kNegligible ? bump.height * std::exp(-exponent) : 0.0;
  }

  int channels_;
  std::vector<Bump> bumps_;
};

inline void add_noise(std::vector<float>& features, float sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0.0F, sigma);
  for (float& feature : features) feature += noise(random);
}

inline FeatureView view(const std::vector<float>& features, int channels, const BevGrid& grid) {
  return {features, channels, grid};
}

}  // namespace bevloc
