#include "evaluation/drive/error_statistics.h"

#include <cassert>
#include <cmath>

namespace bevloc::evaluation {
namespace {

AxisError summarize(const std::vector<double>& absolute) {
  if (absolute.empty()) return {};
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double value : absolute) {
    sum += value;
    sum_of_squares += value * value;
  }
  const auto count = static_cast<double>(absolute.size());
  return {sum / count, std::sqrt(sum_of_squares / count), quantile_of(absolute, 0.95)};
}

}  // namespace

void ErrorStatistics::add(const Se2& error) {
  assert(error.is_finite());
  longitudinal_m_.push_back(std::abs(error.x_m));
  lateral_m_.push_back(std::abs(error.y_m));
  yaw_deg_.push_back(std::abs(degrees(error.yaw_rad)));
}

PoseError ErrorStatistics::summary() const {
  return {summarize(longitudinal_m_), summarize(lateral_m_), summarize(yaw_deg_)};
}

}  // namespace bevloc::evaluation
