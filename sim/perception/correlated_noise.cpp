#include "sim/perception/correlated_noise.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "sim/random.h"
#include "sim/world/path.h"

namespace bevloc::sim {

double CorrelatedNoise::knot(int64_t number) const {
  return Random(mix_seed(seed_) + static_cast<uint64_t>(number)).normal();
}

double CorrelatedNoise::at(double station_m) const {
  const double place = station_m / correlation_m_;
  const double before = std::floor(place);
  const double weight = smooth_step(0.0, 1.0, place - before);
  const auto number = static_cast<int64_t>(before);
  // The division makes the squared weights sum to 1, so the variance is 1 between the knots too.
  return ((1.0 - weight) * knot(number) + weight * knot(number + 1)) /
         std::hypot(1.0 - weight, weight);
}

cv::Mat1f smooth_field(uint64_t seed, int rows, int cols, int cells) {
  Random random(seed);
  cv::Mat1f coarse((rows + cells - 1) / cells + 1, (cols + cells - 1) / cells + 1);
  for (float& value : coarse) value = static_cast<float>(random.normal());
  cv::Mat1f field;
  cv::resize(coarse, field, {coarse.cols * cells, coarse.rows * cells}, 0.0, 0.0, cv::INTER_CUBIC);
  return field(cv::Rect(cells / 2, cells / 2, cols, rows));
}

}  // namespace bevloc::sim
