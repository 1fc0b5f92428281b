#include "tests/fuzz/nasty_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/support/cell_places.h"

namespace bevloc::fuzz {
namespace {

constexpr std::array<std::pair<std::string_view, FeatureSort>, 18> kNames{{
    {"nothing", FeatureSort::kNothing},
    {"too-short", FeatureSort::kTooShort},
    {"too-long", FeatureSort::kTooLong},
    {"zero", FeatureSort::kZero},
    {"constant", FeatureSort::kConstant},
    {"denormal", FeatureSort::kDenormal},
    {"nan", FeatureSort::kNan},
    {"infinity", FeatureSort::kInfinity},
    {"tiny-noise", FeatureSort::kTinyNoise},
    {"hot-cell", FeatureSort::kHotCell},
    {"huge", FeatureSort::kHuge},
    {"huge-cell", FeatureSort::kHugeCell},
    {"alternating", FeatureSort::kAlternating},
    {"dead-channels", FeatureSort::kDeadChannels},
    {"mask", FeatureSort::kMask},
    {"stripes", FeatureSort::kStripes},
    {"noise", FeatureSort::kNoise},
    {"bumps", FeatureSort::kBumps},
}};

constexpr float kHuge = 3e38F;

float real(Random& random, double low, double high) {
  return static_cast<float>(uniform(random, low, high));
}

float sign(Random& random) {
  return integer(random, 0, 1) == 0 ? 1.0F : -1.0F;
}

void add_noise(Random& random, double amplitude, std::vector<float>& features) {
  for (float& feature : features) feature += real(random, -amplitude, amplitude);
}

float& any_of(Random& random, std::vector<float>& features) {
  return features[integer(random, 0, static_cast<int>(features.size()) - 1)];
}

/// Fills each channel with one random value.
void fill_channels(Random& random, double largest, int cells, std::vector<float>& features) {
  for (size_t i = 0; i < features.size(); i += cells) {
    const auto value = static_cast<float>(log_uniform(random, 1e-30, largest)) * sign(random);
    std::fill_n(features.begin() + i, cells, value);
  }
}

/// Sets each cell of every channel to value(row, col).
template <typename Value>
void fill_cells(const BevGrid& grid, std::vector<float>& features, Value value) {
  for (size_t i = 0; i < features.size(); ++i) {
    const int cell = static_cast<int>(i) % grid.cells();
    features[i] = value(cell / grid.cols, cell % grid.cols);
  }
}

void fill_mask(Random& random, const BevGrid& grid, std::vector<float>& features) {
  const int row = integer(random, 0, grid.rows);
  const int col = integer(random, 0, grid.cols);
  fill_cells(grid, features, [&](int r, int c) { return r < row && c < col ? 1.0F : 0.0F; });
}

/// Bumps with a sigma of 1.5 cells, seen from `map_from_vehicle`. They depend on `seed` alone.
void fill_bumps(unsigned seed, const Se2& map_from_vehicle, const BevGrid& grid,
                std::vector<float>& features) {
  Random random(seed);
  std::ranges::fill(features, 0.0F);
  const double width_m = 1.5 * grid.cell_m;
  for (size_t first = 0; first < features.size(); first += grid.cells()) {
    for (int bump = 0; bump < 2; ++bump) {
      const Eigen::Vector2d at(uniform(random, -0.7, 0.7) * grid.x_range_m(),
                               uniform(random, -0.7, 0.7) * grid.y_range_m());
      for (int i = 0; i < grid.cells(); ++i) {
        const Eigen::Vector2d point = map_from_vehicle * test::place_of(grid, i);
        features[first + i] +=
            static_cast<float>(std::exp(-0.5 * (point - at).squaredNorm() / (width_m * width_m)));
      }
    }
  }
}

/// Noise with one defect that makes it unusable. Only for sorts without structure.
std::vector<float> draw_useless(Random& random, FeatureSort sort, const BevGrid& grid,
                                std::vector<float> features) {
  constexpr float kLimit = std::numeric_limits<float>::infinity();
  add_noise(random, 1.0, features);
  switch (sort) {
    case FeatureSort::kNothing:
      return {};
    case FeatureSort::kTooShort:
      features.pop_back();
      break;
    case FeatureSort::kTooLong:
      features.push_back(1.0F);
      break;
    case FeatureSort::kZero:
      std::ranges::fill(features, 0.0F);
      break;
    case FeatureSort::kConstant:
      fill_channels(random, kHuge, grid.cells(), features);
      break;
    case FeatureSort::kDenormal:
      for (float& feature : features) feature *= 1e-40F;
      break;
    case FeatureSort::kNan:
      any_of(random, features) = std::numeric_limits<float>::quiet_NaN();
      break;
    default:
      any_of(random, features) = kLimit * sign(random);
  }
  return features;
}

/// Valid but unusual features. `features` are zero on entry.
std::vector<float> draw_odd(Random& random, FeatureSort sort, const BevGrid& grid,
                            std::vector<float> features) {
  switch (sort) {
    case FeatureSort::kTinyNoise:
      fill_channels(random, 1.0, grid.cells(), features);
      add_noise(random, log_uniform(random, 1e-7, 1e-2), features);
      break;
    case FeatureSort::kHotCell:
      any_of(random, features) = static_cast<float>(log_uniform(random, 1e-3, kHuge));
      break;
    case FeatureSort::kHuge:
      for (float& feature : features) feature = kHuge * sign(random);
      break;
    case FeatureSort::kHugeCell:
      std::ranges::fill(features, -kHuge);
      any_of(random, features) = kHuge;
      break;
    case FeatureSort::kAlternating:
      fill_cells(grid, features,
                 [](int row, int col) { return (row + col) % 2 == 0 ? 1.0F : -1.0F; });
      break;
    case FeatureSort::kDeadChannels:
      add_noise(random, 1.0, features);
      fill_channels(random, 1.0, grid.cells(), features);
      std::for_each_n(features.begin(), grid.cells(),
                      [&](float& feature) { feature = real(random, -1.0, 1.0); });
      break;
    case FeatureSort::kMask:
      fill_mask(random, grid, features);
      break;
    case FeatureSort::kStripes: {
      const bool along_x = integer(random, 0, 1) == 0;
      fill_cells(grid, features,
                 [&](int row, int col) { return (along_x ? col : row) % 3 == 0 ? 1.0F : 0.0F; });
      break;
    }
    default:
      add_noise(random, log_uniform(random, 0.1, 1e3), features);
  }
  return features;
}

/// Draws sorts without structure less often, because solvers treat all of them alike.
FeatureSort draw_sort(Random& random) {
  const FeatureSort sort = kNames[integer(random, 0, static_cast<int>(kNames.size()) - 1)].second;
  return has_no_structure(sort) && integer(random, 0, 3) > 0 ? draw_sort(random) : sort;
}

/// A random pose within the hypotheses.
Se2 draw_pose(Random& random, const HypothesisGrid& hypotheses) {
  const auto draw = [&](const HypothesisAxis& axis) {
    return uniform(random, -axis.farthest(), axis.farthest());
  };
  return {draw(hypotheses.x_m), draw(hypotheses.y_m), draw(hypotheses.yaw_rad)};
}

}  // namespace

std::string_view name_of(FeatureSort sort) {
  return std::ranges::find(kNames, sort, &std::pair<std::string_view, FeatureSort>::second)->first;
}

bool has_no_structure(FeatureSort sort) {
  return sort <= FeatureSort::kInfinity;
}

bool has_structure(FeatureSort sort) {
  return sort == FeatureSort::kNoise || sort == FeatureSort::kBumps;
}

FeaturePair draw_features(Random& random, const SolverRequest& request) {
  FeaturePair pair{draw_sort(random), draw_sort(random), {}, {}};
  // Otherwise both sides would rarely have the same sort.
  if (integer(random, 0, 3) == 0) pair.map_sort = pair.bev_sort;
  const auto seed = static_cast<unsigned>(random());
  const auto draw = [&](FeatureSort sort, const Se2& pose) {
    std::vector<float> features(static_cast<size_t>(request.channels) * request.grid.cells());
    if (has_no_structure(sort)) return draw_useless(random, sort, request.grid, features);
    if (sort != FeatureSort::kBumps) return draw_odd(random, sort, request.grid, features);
    fill_bumps(seed, pose, request.grid, features);
    return features;
  };
  pair.bev = draw(pair.bev_sort, draw_pose(random, request.hypotheses));
  pair.map = draw(pair.map_sort, {});
  if (pair.map_sort == pair.bev_sort && integer(random, 0, 3) == 0) pair.map = pair.bev;
  return pair;
}

}  // namespace bevloc::fuzz
