#include "pipeline/calibration/online/online_calibration.h"

#include <algorithm>
#include <cmath>

namespace bevloc {
namespace {

/// Between two observations. Matches of the next frameset see the same road.
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
/// They follow no faster than this per second of learning. A street that contradicts the map for
/// some seconds (grass on the kerb, wrong time stamps) would otherwise bend the calibration at
/// once.
constexpr double kFastest_radps = radians(0.005);
constexpr double kFastest_mps = 0.0004;

/// An error is beyond its bound for certain if it is by this many sigmas.
constexpr double kCertainSigmas = 0.5;

// Agreement of a camera with the map: ZNCC over the cells that it sees, against the median camera.
constexpr double kFade_s = 20.0;
constexpr double kLeastSeen_s = 15.0;
// The share of a swapped camera is mostly below 0.4. That of a camera at its own place is mostly
// 0.6 or more.
constexpr double kContradictingShare = 0.4;
constexpr double kAgreeingShare = 0.5;
/// A camera contradicts the map if its share stays below kContradictingShare for this long. In
/// drives without a fault, the share of a single camera stayed below it for 1 s or less.
constexpr double kLeastContradicted_s = 4.0;
// In drives without a fault, the shares of both cameras of one side stayed below it for 23 s or
// less. So a second counts as 0.1 s while the share of the other camera is below
// kWellAgreeingShare.
constexpr double kWellAgreeingShare = 0.7;
constexpr double kHiddenSideRate = 0.1;
/// Least agreement of the median camera. If it is lower, no camera is judged.
constexpr double kLeastMedian = 0.1;

/// The other camera that sees the same side of the road; -1 for the front and the back one.
constexpr std::array<int, kCameraCount> kSameSide = {3, -1, 5, 0, -1, 2};

double agreement(const SeenByCamera& seen) {
  const double squares = seen.map_square * seen.bev_square;
  return squares > 0.0 ? seen.product / std::sqrt(squares) : 0.0;
}

}  // namespace

OnlineCalibration::OnlineCalibration(const Rig& rig, const BevGrid& grid, int channels,
                                     const OnlineCalibrationOptions& options)
    : options_(options), sums_(grid, channels), filter_(rig, {}) {}

bool OnlineCalibration::restore(const ExtrinsicErrors& errors,
                                const ExtrinsicCovariance& covariance) {
  for (int error = 0; error < kExtrinsicErrors; ++error) {
    if (!(std::abs(errors(error)) <= limit_of(error))) return false;
  }
  if (!filter_.restore(errors, covariance)) return false;
  used_ = filter_.errors();
  start_ = used_;
  return true;
}

double OnlineCalibration::limit_of(int error) const {
  return error % kErrorsPerCamera < 3 ? options_.max_rotation_rad : options_.max_translation_m;
}

bool OnlineCalibration::observe(const CalibrationObservation& observation) {
  const bool is_usable = observation.driving && observation.match.evidence == Evidence::kGood &&
                         observation.cameras.all();
  const bool learns = is_usable && observation.tracking && is_clear(observation);
  learn_heading(observation, learns);
  if (!is_usable) return false;
  if (observed_ && observation.time - *observed_ < kPeriod) return false;
  const double step_s =
      observed_ ? std::min(to_seconds(observation.time - *observed_), kLongestStep_s) : 0.0;
  observed_ = observation.time;
  sums_.compute(observation.cells, information_);
  const double kept = std::exp(-step_s / kFade_s);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    SeenByCamera& sum = seen_[camera];
    const SeenByCamera& now = information_.seen[camera];
    sum = {kept * sum.product + now.product, kept * sum.map_square + now.map_square,
           kept * sum.bev_square + now.bev_square};
  }
  seen_s_ += step_s;
  judge_agreement(step_s);
  // Two cameras in each other's place would pull the estimates of all.
  if (!learns || contradicting_.any()) return false;
  filter_.update(information_, used_, step_s);
  judge_bounds();
  if (beyond_bounds_.any()) return use_again(start_);
  unfollowed_s_ += step_s;
  return follow_estimate();
}

void OnlineCalibration::learn_heading(const CalibrationObservation& observation, bool is_clear) {
  std::optional<Se2> matched;
  if (is_clear) {
    matched = observation.map_from_vehicle;
    matched->yaw_rad += filter_.turn_by(used_);  // as it would be without the used errors
  }
  const auto turn = direction_.add(matched, observation.driven);
  if (turn) filter_.update_heading(*turn);
}

bool OnlineCalibration::is_clear(const CalibrationObservation& observation) const {
  const MatchResult& match = observation.match;
  return std::abs(match.correction.y_m) < kFarthestLateral_m &&
         std::abs(match.correction.yaw_rad) < kFarthestYaw_rad &&
         match.covariance(1, 1) < kLargestLateralSigma_m * kLargestLateralSigma_m &&
         match.covariance(2, 2) < kLargestYawSigma_rad * kLargestYawSigma_rad;
}

void OnlineCalibration::judge_agreement(double step_s) {
  if (seen_s_ < kLeastSeen_s) return;
  std::array<double, kCameraCount> shares{};
  std::ranges::transform(seen_, shares.begin(), agreement);
  std::array<double, kCameraCount> sorted = shares;
  std::ranges::sort(sorted);
  // The better of the two in the middle: two swapped cameras leave four good ones.
  const double median = sorted[kCameraCount / 2];
  if (median < kLeastMedian) return;
  for (double& share : shares) share /= median;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const double limit = contradicting_[camera] ? kAgreeingShare : kContradictingShare;
    if (shares[camera] >= limit) {
      contradicted_s_[camera] = 0.0;
      contradicting_[camera] = false;
      continue;
    }
    const int other = kSameSide[camera];
    const bool is_side_hidden = other >= 0 && shares[other] < kWellAgreeingShare;
    contradicted_s_[camera] += is_side_hidden ? kHiddenSideRate * step_s : step_s;
    contradicting_[camera] = contradicted_s_[camera] >= kLeastContradicted_s;
  }
}

void OnlineCalibration::judge_bounds() {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    beyond_bounds_[camera] = false;
    for (int i = 0; i < kErrorsPerCamera; ++i) {
      const int error = camera * kErrorsPerCamera + i;
      const double sigma = std::sqrt(filter_.covariance()(error, error));
      if (std::abs(filter_.errors()(error)) - kCertainSigmas * sigma > limit_of(error)) {
        beyond_bounds_[camera] = true;
      }
    }
  }
}

bool OnlineCalibration::use_again(const ExtrinsicErrors& errors) {
  unfollowed_s_ = 0.0;
  if (used_ == errors) return false;
  used_ = errors;
  return true;
}

bool OnlineCalibration::follow_estimate() {
  ExtrinsicErrors wanted = filter_.errors();
  bool moved = false;
  for (int error = 0; error < kExtrinsicErrors; ++error) {
    const bool is_rotation = error % kErrorsPerCamera < 3;
    const double reach = unfollowed_s_ * (is_rotation ? kFastest_radps : kFastest_mps);
    wanted(error) = std::clamp(wanted(error), -limit_of(error), limit_of(error));
    wanted(error) = std::clamp(wanted(error), used_(error) - reach, used_(error) + reach);
    moved |= std::abs(wanted(error) - used_(error)) > (is_rotation ? kStep_rad : kStep_m);
  }
  if (!moved) return false;
  used_ = wanted;
  unfollowed_s_ = 0.0;
  return true;
}

}  // namespace bevloc
