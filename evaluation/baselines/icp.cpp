#include "evaluation/baselines/icp.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "evaluation/baselines/line_points.h"
#include "evaluation/baselines/nearest_line.h"
#include "evaluation/baselines/pose_least_squares.h"

namespace bevloc::evaluation {
namespace {

constexpr double kFirstRadius_m = 2.5;
constexpr double kLastRadius_m = 0.6;
constexpr double kRadiusRatio = 0.9;
constexpr int kIcpIterations = 25;
static_assert(kFirstRadius_m > kLastRadius_m);

/// The weight of a larger distance decreases (Huber).
constexpr double kHuber_m = 0.3;

/// Cosine of 30 degrees: the largest angle between lines that may be assigned to each other.
constexpr double kLeastAgreement = 0.866;

}  // namespace

Se2 IterativeClosestPoints::correct(const BaselineInput& input) {
  const ClassLines perceived = lines_of_mask(input.perceived);
  const ClassLines map = lines_of_raster(input.raster);
  std::vector<NearestLine> nearest(map.begin(), map.end());
  Se2 correction;
  double radius_m = kFirstRadius_m;
  for (int i = 0; i < kIcpIterations; ++i) {
    PoseLeastSquares problem(correction);
    problem.add_prior(ranges_);
    const Se2 turn{0.0, 0.0, correction.yaw_rad};
    for (size_t k = 0; k < perceived.size(); ++k) {
      for (const LinePoint& point : perceived[k]) {
        const Eigen::Vector2d moved = correction * point.position_m;
        const LinePoint* line = nearest[k].to(moved);
        if (line == nullptr || (line->position_m - moved).norm() > radius_m) continue;
        if (std::abs(line->normal.dot(turn * point.normal)) < kLeastAgreement) continue;
        const double distance_m = line->normal.dot(moved - line->position_m);
        const double weight = std::min(1.0, kHuber_m / std::max(std::abs(distance_m), 1e-9));
        problem.add(moved, distance_m, line->normal, weight);
      }
    }
    correction = problem.solve(ranges_, 0.0);
    radius_m = std::max(kLastRadius_m, kRadiusRatio * radius_m);
  }
  return correction;
}

}  // namespace bevloc::evaluation
