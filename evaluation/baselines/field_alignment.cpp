#include "evaluation/baselines/field_alignment.h"

#include <algorithm>
#include <vector>

#include "evaluation/baselines/pose_least_squares.h"

namespace bevloc::evaluation {
namespace {

/// The loss is nearly constant for distances well above this.
constexpr double kTruncation_m = 0.6;

// The coarse grid: number of corrections on each side of zero, and number of starts kept.
constexpr int kHalfX = 4;
constexpr int kHalfY = 3;
constexpr int kHalfYaw = 2;
constexpr size_t kStarts = 4;
/// The coarse grid uses every kCoarseStride-th point.
constexpr size_t kCoarseStride = 4;

constexpr int kAlignmentIterations = 20;
constexpr double kFirstDamping = 1e-3;
constexpr double kLargestDamping = 1e3;

struct Start {
  Se2 correction;
  double cost = 0.0;
};

/// The weight of a squared distance that has the gradient of Geman and McClure's robust loss.
double weight_of(double distance_m) {
  const double relative = distance_m / kTruncation_m;
  const double root = 1.0 / (1.0 + relative * relative);
  return root * root;
}

double loss_of(double distance_m) {
  const double square = distance_m * distance_m;
  return square / (1.0 + square / (kTruncation_m * kTruncation_m));
}

double cost_of(std::span<const PointsOnField> pairs, const HypothesisGrid& ranges,
               const Se2& correction, size_t stride) {
  double sum = 0.0;
  for (const PointsOnField& pair : pairs) {
    if (pair.field.is_empty()) continue;
    for (size_t i = 0; i < pair.points.size(); i += stride) {
      sum += loss_of(pair.field.at(correction * pair.points[i].position_m).distance_m);
    }
  }
  return sum * static_cast<double>(stride) * kPointInformation + prior_cost(correction, ranges);
}

std::vector<Start> best_starts(std::span<const PointsOnField> pairs, const HypothesisGrid& ranges) {
  std::vector<Start> starts;
  for (int x = -kHalfX; x <= kHalfX; ++x) {
    for (int y = -kHalfY; y <= kHalfY; ++y) {
      for (int yaw = -kHalfYaw; yaw <= kHalfYaw; ++yaw) {
        const Se2 correction{x * ranges.x_m.range / kHalfX, y * ranges.y_m.range / kHalfY,
                             yaw * ranges.yaw_rad.range / kHalfYaw};
        starts.push_back({correction, cost_of(pairs, ranges, correction, kCoarseStride)});
      }
    }
  }
  std::ranges::partial_sort(starts, starts.begin() + kStarts, {}, &Start::cost);
  starts.resize(kStarts);
  return starts;
}

PoseLeastSquares linearised(std::span<const PointsOnField> pairs, const HypothesisGrid& ranges,
                            const Se2& correction) {
  PoseLeastSquares problem(correction);
  problem.add_prior(ranges);
  for (const PointsOnField& pair : pairs) {
    if (pair.field.is_empty()) continue;
    for (const LinePoint& point : pair.points) {
      const Eigen::Vector2d moved = correction * point.position_m;
      const auto [distance_m, gradient] = pair.field.at(moved);
      problem.add(moved, distance_m, gradient, weight_of(distance_m));
    }
  }
  return problem;
}

/// Levenberg-Marquardt from one start.
Start descend(std::span<const PointsOnField> pairs, const HypothesisGrid& ranges,
              const Se2& start) {
  Start best{start, cost_of(pairs, ranges, start, 1)};
  double damping = kFirstDamping;
  PoseLeastSquares problem = linearised(pairs, ranges, best.correction);
  for (int i = 0; i < kAlignmentIterations && damping < kLargestDamping; ++i) {
    const Se2 candidate = problem.solve(ranges, damping);
    const double cost = cost_of(pairs, ranges, candidate, 1);
    if (cost < best.cost) {
      best = {candidate, cost};
      problem = linearised(pairs, ranges, candidate);
      damping *= 0.1;
    } else {
      damping *= 10.0;
    }
  }
  return best;
}

}  // namespace

Se2 align(std::span<const PointsOnField> pairs, const HypothesisGrid& ranges) {
  std::vector<Start> ends;
  for (const Start& start : best_starts(pairs, ranges)) {
    ends.push_back(descend(pairs, ranges, start.correction));
  }
  return std::ranges::min_element(ends, {}, &Start::cost)->correction;
}

}  // namespace bevloc::evaluation
