#include "sim/sensors/gnss.h"

#include <cassert>
#include <cmath>

#include "sim/random.h"

namespace bevloc::sim {
namespace {

constexpr double kPositionDrift_m = 1.0;
constexpr double kPositionDriftTime_s = 40.0;
constexpr double kPositionWhite_m = 0.25;
constexpr double kHeadingDrift_rad = radians(1.0);
constexpr double kHeadingDriftTime_s = 20.0;
constexpr double kHeadingWhite_rad = radians(0.3);

/// A first-order Gauss-Markov process that starts in its stationary state.
class GaussMarkov {
 public:
  GaussMarkov(double sigma, double time_constant_s, double period_s, Random& random)
      : keep_(std::exp(-period_s / time_constant_s)),
        drive_(sigma * std::sqrt(1.0 - keep_ * keep_)),
        value_(random.normal(0.0, sigma)) {}

  /// Returns the current value and advances by one period.
  double step(Random& random) {
    const double value = value_;
    value_ = keep_ * value_ + random.normal(0.0, drive_);
    return value;
  }

 private:
  double keep_;
  double drive_;
  double value_;
};

}  // namespace

GnssSimulator::GnssSimulator(const Drive& drive, uint64_t seed) : drive_(drive) {
  Random random(seed_for(seed, "gnss"));
  GaussMarkov east(kPositionDrift_m, kPositionDriftTime_s, kPeriod_s, random);
  GaussMarkov north(kPositionDrift_m, kPositionDriftTime_s, kPeriod_s, random);
  GaussMarkov heading(kHeadingDrift_rad, kHeadingDriftTime_s, kPeriod_s, random);
  const auto readings = static_cast<size_t>(drive.duration_s() / kPeriod_s) + 1;
  errors_.resize(readings);
  for (Error& error : errors_) {
    error.position_m.x() = east.step(random) + random.normal(0.0, kPositionWhite_m);
    error.position_m.y() = north.step(random) + random.normal(0.0, kPositionWhite_m);
    error.heading_rad = heading.step(random) + random.normal(0.0, kHeadingWhite_rad);
  }
}

GnssReading GnssSimulator::reading(size_t index) const {
  assert(index < errors_.size());
  GnssReading reading;
  reading.time_s = static_cast<double>(index) * kPeriod_s;
  const Se2 truth = drive_.at(reading.time_s).map_from_vehicle;
  reading.position_m = truth.translation() + errors_[index].position_m;
  reading.heading_rad = wrap_angle(truth.yaw_rad + errors_[index].heading_rad);
  reading.position_sigma_m = std::hypot(kPositionDrift_m, kPositionWhite_m);
  reading.heading_sigma_rad = std::hypot(kHeadingDrift_rad, kHeadingWhite_rad);
  return reading;
}

}  // namespace bevloc::sim
