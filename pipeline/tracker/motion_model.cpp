#include "pipeline/tracker/motion_model.h"

#include <cassert>
#include <cmath>

namespace bevloc {
namespace {

/// Transition matrix of the error state. The pose error is expressed in the moving vehicle frame.
/// `turns` says whether the vehicle may turn in this step.
FilterState::Covariance transition(const MeasuredMotion& motion, double speed_mps, bool turns,
                                   double duration_s, const Se2& step) {
  using S = FilterState;
  const double c = std::cos(step.yaw_rad);
  const double s = std::sin(step.yaw_rad);
  const double measured_m = motion.speed_mps * duration_s;
  FilterState::Covariance f = FilterState::Covariance::Identity();
  f.block<2, 2>(S::kX, S::kX) << c, s, -s, c;
  // A yaw error rotates the step.
  f(S::kX, S::kYaw) = -c * step.y_m + s * step.x_m;
  f(S::kY, S::kYaw) = s * step.y_m + c * step.x_m;
  f(S::kX, S::kSpeedScale) = measured_m;
  if (turns) {
    f(S::kYaw, S::kYawRateBias) = -duration_s;
    f(S::kY, S::kYawRateBias) = -0.5 * speed_mps * duration_s * duration_s;
  }
  return f;
}

/// Diagonal of the process noise covariance of the pose and of the odometry errors.
Eigen::Matrix<double, FilterState::kMatchError, 1> motion_variance(double distance_m, bool turns,
                                                                   double duration_s,
                                                                   const MotionNoise& noise) {
  const double half_square_s2 = 0.5 * duration_s * duration_s;
  Eigen::Matrix<double, FilterState::kMatchError, 1> variance;
  const double yaw = square_of(noise.yaw_rad_per_sqrt_s) * duration_s +
                     square_of(noise.yaw_acceleration_radps2 * half_square_s2);
  variance << square_of(noise.longitudinal_m_per_sqrt_m) * distance_m +
                  square_of(noise.acceleration_mps2 * half_square_s2),
      square_of(noise.lateral_m_per_sqrt_m) * distance_m, turns ? yaw : 0.0,
      square_of(noise.speed_scale_per_sqrt_s) * duration_s,
      square_of(noise.yaw_rate_bias_radps_per_sqrt_s) * duration_s;
  return variance;
}

/// An unmeasured yaw acceleration turns the vehicle during the step and so moves it to the side.
/// Adds the part that motion_variance() lacks: the variance across and its covariance with the yaw.
void add_sideways_motion(double speed_mps, double duration_s, const MotionNoise& noise,
                         FilterState& state) {
  using S = FilterState;
  const double turned_rad = 0.5 * noise.yaw_acceleration_radps2 * duration_s * duration_s;
  const double sideways_m = speed_mps * turned_rad * duration_s / 3.0;
  state.covariance(S::kY, S::kY) += square_of(sideways_m);
  state.covariance(S::kY, S::kYaw) += sideways_m * turned_rad;
  state.covariance(S::kYaw, S::kY) += sideways_m * turned_rad;
}

}  // namespace

void FilterState::apply(const Vector& error) {
  map_from_vehicle = map_from_vehicle * Se2{error(kX), error(kY), error(kYaw)};
  speed_scale_error += error(kSpeedScale);
  yaw_rate_bias_radps += error(kYawRateBias);
  match_error += error.segment<3>(kMatchError);
  gnss_error += error.segment<3>(kGnssError);
}

void predict(const MeasuredMotion& motion, double duration_s, const MotionNoise& noise,
             const ErrorCorrelation& correlation, FilterState& state) {
  using S = FilterState;
  assert(duration_s >= 0.0);
  const double speed_mps = state.speed_mps(motion);
  const double distance_m = std::abs(speed_mps) * duration_s;
  const Eigen::Vector3d match_share = correlation.match_m.unaryExpr(
      [distance_m](double length_m) { return kept_share(distance_m, length_m); });
  const double gnss_share = kept_share(duration_s, correlation.gnss_s);
  const Se2 step = arc_motion(speed_mps, state.yaw_rate_radps(motion), duration_s);
  const bool turns = !state.stands(motion) || duration_s > kLongestStandstillStep_s;
  S::Covariance f = transition(motion, speed_mps, turns, duration_s, step);
  f.diagonal().segment<3>(S::kMatchError) = match_share;
  f.diagonal().segment<3>(S::kGnssError).setConstant(gnss_share);
  const S::Covariance moved = f * state.covariance * f.transpose();
  state.covariance = 0.5 * (moved + moved.transpose());
  auto variance = state.covariance.diagonal();
  variance.head<S::kMatchError>() += motion_variance(distance_m, turns, duration_s, noise);
  if (turns) add_sideways_motion(speed_mps, duration_s, noise, state);
  variance.segment<3>(S::kMatchError) += Eigen::Vector3d::Ones() - match_share.cwiseAbs2();
  variance.segment<3>(S::kGnssError).array() += 1.0 - square_of(gnss_share);
  state.match_error = state.match_error.cwiseProduct(match_share);
  state.gnss_error *= gnss_share;
  state.map_from_vehicle = state.map_from_vehicle * step;
}

}  // namespace bevloc
