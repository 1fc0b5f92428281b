#include "pipeline/online_calibration/online_calibration.h"

#include <algorithm>
#include <cmath>

namespace bevloc {
namespace {

/// The least time between two observations, because matches of the next frameset see the same road.
constexpr Duration kPeriod = std::chrono::milliseconds(380);
/// An observation counts for at most this long, also after a pause.
constexpr double kLongestStep_s = 1.0;

// A clear match: close to the prior, and exact across the road and in heading.
constexpr double kFarthestLateral_m = 0.6;
constexpr double kFarthestYaw_rad = radians(1.5);
constexpr double kLargestLateralSigma_m = 0.3;
constexpr double kLargestYawSigma_rad = radians(0.6);

/// The used errors follow the estimate when it has moved by more than this.
constexpr double kStep_rad = radians(0.03);
constexpr double kStep_m = 0.005;
/// The used errors change no faster than this per second of learning. A street that contradicts the
/// map for some seconds (grass on the kerb, wrong time stamps) would otherwise bend the calibration
/// at once.
constexpr double kFastest_radps = radians(0.005);
constexpr double kFastest_mps = 0.0004;
/// A single change of the used errors is at most this many steps, even after a long time without a
/// change. Observations come up to 1 s apart, so a change may reach 1.17 steps without this limit.
constexpr double kMostSteps = 1.2;

/// A camera is at fault if an error is beyond its bound by more than this many sigmas.
constexpr double kSigmasBeyond = 0.5;

/// If more cameras than this seem out of place, the map or the road is more likely to differ.
constexpr size_t kMostLeftOut = 2;

}  // namespace

OnlineCalibration::OnlineCalibration(const Rig& rig, const BevGrid& grid,
                                     const OnlineCalibrationOptions& options)
    : options_(options), sums_(grid), filter_(rig) {}

Status OnlineCalibration::restore(const ExtrinsicErrors& errors,
                                  const ExtrinsicCovariance& covariance) {
  for (int error = 0; error < kExtrinsicErrors; ++error) {
    if (!is_beyond(error, errors(error), covariance(error, error))) continue;
    return fail("found learned errors of the camera {} beyond their bounds, wanted smaller ones",
                kCameraNames[error / kErrorsPerCamera]);
  }
  if (!filter_.restore(errors, covariance)) {
    return fail(
        "found a covariance of the learned errors that is not positive definite, wanted one "
        "that is");
  }
  used_ = within_bounds(filter_.errors());
  start_ = used_;
  return {};
}

double OnlineCalibration::limit_of(int error) const {
  return error % kErrorsPerCamera < 3 ? options_.max_rotation_rad : options_.max_translation_m;
}

bool OnlineCalibration::is_beyond(int error, double value, double variance) const {
  return std::abs(value) - kSigmasBeyond * std::sqrt(variance) > limit_of(error);
}

ExtrinsicErrors OnlineCalibration::within_bounds(ExtrinsicErrors errors) const {
  for (int error = 0; error < kExtrinsicErrors; ++error) {
    errors(error) = std::clamp(errors(error), -limit_of(error), limit_of(error));
  }
  return errors;
}

bool OnlineCalibration::observe(const CalibrationObservation& observation) {
  const bool is_usable = observation.driving && observation.match.evidence == Evidence::kGood;
  const bool learns = is_usable && observation.cameras.all() && observation.tracking &&
                      contradicting().none() && is_clear(observation);
  learn_heading(observation, learns);
  if (!is_usable) return false;
  if (observed_ && observation.time - *observed_ < kPeriod) return false;
  const double step_s =
      observed_ ? std::min(to_seconds(observation.time - *observed_), kLongestStep_s) : 0.0;
  observed_ = observation.time;
  sums_.compute(observation.cells, information_);
  agreement_.add(information_.seen, observation.cameras, step_s);
  leave_out_faults();
  if (contradicting().any()) return use_again(start_);
  if (!learns) return false;
  filter_.update(information_, used_, step_s);
  judge_bounds();
  leave_out_faults();
  if (beyond_bounds_.any()) return use_again(start_);
  unfollowed_s_ += step_s;
  return follow_estimate();
}

void OnlineCalibration::learn_heading(const CalibrationObservation& observation, bool is_clear) {
  std::optional<Se2> matched;
  if (is_clear) {
    matched = observation.map_from_vehicle;
    matched->yaw_rad += filter_.turn_by(used_);  // the heading without the used errors
  }
  // A pose that is found again may lie elsewhere than the lost one, so the stretch must end.
  const auto driven = observation.tracking ? observation.driven : std::nullopt;
  const auto turn = direction_.add(matched, driven);
  if (turn) filter_.update_heading(*turn);
}

bool OnlineCalibration::is_clear(const CalibrationObservation& observation) const {
  const MatchResult& match = observation.match;
  return std::abs(match.correction.y_m) < kFarthestLateral_m &&
         std::abs(match.correction.yaw_rad) < kFarthestYaw_rad &&
         match.covariance(1, 1) < kLargestLateralSigma_m * kLargestLateralSigma_m &&
         match.covariance(2, 2) < kLargestYawSigma_rad * kLargestYawSigma_rad;
}

void OnlineCalibration::judge_bounds() {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    beyond_bounds_[camera] = false;
    for (int i = 0; i < kErrorsPerCamera; ++i) {
      const int error = camera * kErrorsPerCamera + i;
      if (is_beyond(error, filter_.errors()(error), filter_.covariance()(error, error))) {
        beyond_bounds_[camera] = true;
      }
    }
  }
}

void OnlineCalibration::leave_out_faults() {
  const CameraMask wanted = left_out_ | faults();
  if (wanted.count() <= kMostLeftOut) left_out_ = wanted;
}

bool OnlineCalibration::use_again(const ExtrinsicErrors& errors) {
  unfollowed_s_ = 0.0;
  if (used_ == errors) return false;
  used_ = errors;
  return true;
}

bool OnlineCalibration::follow_estimate() {
  ExtrinsicErrors wanted = within_bounds(filter_.errors());
  bool moved = false;
  for (int error = 0; error < kExtrinsicErrors; ++error) {
    const bool is_rotation = error % kErrorsPerCamera < 3;
    const double step = is_rotation ? kStep_rad : kStep_m;
    const double reach =
        std::min(unfollowed_s_ * (is_rotation ? kFastest_radps : kFastest_mps), kMostSteps * step);
    wanted(error) = std::clamp(wanted(error), used_(error) - reach, used_(error) + reach);
    moved |= std::abs(wanted(error) - used_(error)) > step;
  }
  if (!moved) return false;
  used_ = wanted;
  unfollowed_s_ = 0.0;
  return true;
}

}  // namespace bevloc
