// Random values that vary smoothly along a line or over a grid.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace bevloc::sim {

/// Standard normal values along a line. They are similar within `correlation_m` and independent
/// beyond twice that distance. Immutable, and so thread-safe.
class CorrelatedNoise {
 public:
  CorrelatedNoise(uint64_t seed, double correlation_m)
      : seed_(seed), correlation_m_(correlation_m) {}

  double at(double station_m) const;

 private:
  double knot(int64_t number) const;

  uint64_t seed_;
  double correlation_m_;
};

/// A rows x cols field of roughly standard normal values, smooth over `cells` cells.
cv::Mat1f smooth_field(uint64_t seed, int rows, int cols, int cells);

}  // namespace bevloc::sim
