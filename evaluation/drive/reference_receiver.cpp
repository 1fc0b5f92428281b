#include "evaluation/drive/reference_receiver.h"

#include <cmath>

#include "sim/random.h"

namespace bevloc::evaluation {
namespace {

constexpr double kReferencePeriod_s = 0.02;

/// A first-order Gauss-Markov process, sampled with the period of the reference.
class DriftingError {
 public:
  DriftingError(sim::Random& random, double sigma, double time_s)
      : random_(random), sigma_(sigma), keep_(std::exp(-kReferencePeriod_s / time_s)) {
    value_ = random_.normal(0.0, sigma_);
  }
  double next() {
    value_ = keep_ * value_ + random_.normal(0.0, sigma_ * std::sqrt(1.0 - keep_ * keep_));
    return value_;
  }

 private:
  sim::Random& random_;
  double sigma_;
  double keep_;
  double value_ = 0.0;
};

}  // namespace

ReferenceTrajectory receive_reference(const std::function<Se2(double time_s)>& truth,
                                      double duration_s, uint64_t seed, Time drive_start) {
  sim::Random random(seed);
  DriftingError slow_x(random, 0.015, 20.0);
  DriftingError slow_y(random, 0.015, 20.0);
  DriftingError slow_yaw(random, radians(0.05), 30.0);
  DriftingError fast_x(random, 0.01, 1.0);
  DriftingError fast_y(random, 0.01, 1.0);
  DriftingError fast_yaw(random, radians(0.05), 1.0);
  std::vector<ReferenceTrajectory::Pose> poses;
  const int count = static_cast<int>(duration_s / kReferencePeriod_s);
  for (int i = 0; i < count; ++i) {
    const double time_s = i * kReferencePeriod_s;
    Se2 pose = truth(time_s);
    pose.x_m += slow_x.next() + fast_x.next();
    pose.y_m += slow_y.next() + fast_y.next();
    pose.yaw_rad = wrap_angle(pose.yaw_rad + slow_yaw.next() + fast_yaw.next());
    poses.push_back({drive_start + from_seconds(time_s), pose});
  }
  return ReferenceTrajectory(std::move(poses));
}

ReferenceTrajectory receive_reference(const sim::Drive& drive, uint64_t seed, Time drive_start) {
  return receive_reference([&drive](double time_s) { return drive.at(time_s).map_from_vehicle; },
                           drive.duration_s(), seed, drive_start);
}

}  // namespace bevloc::evaluation
