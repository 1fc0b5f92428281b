#include "pipeline/tracker/start_heading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bevloc {
namespace {

/// The vehicle counts as standing if, after this time, it is still within this distance of the
/// start of the way.
constexpr double kStanding_m = 0.5;
constexpr double kStanding_s = 2.0;
/// After this time the way begins again, because dead reckoning has become too inexact.
constexpr double kLongest_s = 30.0;
/// Longest time between two samples of odometry, and between a position and the latest sample.
constexpr double kLongestGap_s = 0.5;
/// The lengths of the two ways may differ by this many standard deviations of GNSS, and by this
/// share because of the wheels.
constexpr double kLengthSigmas = 4.0;
constexpr double kLengthShare = 0.05;

double angle_of(const Eigen::Vector2d& vector) {
  return std::atan2(vector.y(), vector.x());
}

}  // namespace

void StartHeading::add(const OdometrySample& sample) {
  if (odometry_) {
    const double speed_mps = 0.5 * (odometry_->speed_mps + sample.speed_mps);
    const double yaw_rate_radps = 0.5 * (odometry_->yaw_rate_radps + sample.yaw_rate_radps);
    const double step_s = to_seconds(sample.time - odometry_->time);
    if (step_s > kLongestGap_s) begin_.reset();
    begin_from_odometry_ = begin_from_odometry_ * arc_motion(speed_mps, yaw_rate_radps, step_s);
  }
  odometry_ = sample;
}

std::optional<GnssSample::Yaw> StartHeading::add(Time time, const Eigen::Vector2d& position_m,
                                                 double sigma_m) {
  if (!odometry_) return std::nullopt;
  const double rest_s = to_seconds(time - odometry_->time);
  if (std::abs(rest_s) > kLongestGap_s) return std::nullopt;
  // The motion until the position. It is backwards if the position is older than the latest sample.
  const Se2 rest = arc_motion(odometry_->speed_mps, odometry_->yaw_rate_radps, rest_s);
  const Se2 begin_from_now = begin_from_odometry_ * rest;
  const Eigen::Vector2d driven_m = begin_from_now.translation();
  const Begin here{time, position_m, sigma_m};
  const double elapsed_s = begin_ ? to_seconds(time - begin_->time) : 0.0;
  const bool stands = elapsed_s > kStanding_s && driven_m.norm() < kStanding_m;
  if (!begin_ || elapsed_s > kLongest_s || stands) {
    begin(here);
    return std::nullopt;
  }
  const Eigen::Vector2d moved_m = position_m - begin_->position_m;
  const double way_sigma_m = std::numbers::sqrt2 * std::max(sigma_m, begin_->sigma_m);
  if (std::abs(moved_m.norm() - driven_m.norm()) >
      kLengthSigmas * way_sigma_m + kLengthShare * driven_m.norm()) {
    begin(here);
    return std::nullopt;
  }
  if (driven_m.norm() < kStanding_m) return std::nullopt;
  const double sigma_rad =
      std::hypot(way_sigma_m / driven_m.norm(), yaw_rate_bias_sigma_radps_ * elapsed_s);
  if (!(sigma_rad <= kLargestSigma_rad)) return std::nullopt;
  const double yaw_at_begin_rad = angle_of(moved_m) - angle_of(driven_m);
  return GnssSample::Yaw{wrap_angle(yaw_at_begin_rad + begin_from_now.yaw_rad), sigma_rad};
}

void StartHeading::reset() {
  odometry_.reset();
  begin_.reset();
  begin_from_odometry_ = {};
}

void StartHeading::begin(const Begin& begin) {
  begin_ = begin;
  // The pose at the latest sample, as seen from this position.
  begin_from_odometry_ = arc_motion(odometry_->speed_mps, odometry_->yaw_rate_radps,
                                    to_seconds(odometry_->time - begin.time));
}

}  // namespace bevloc
