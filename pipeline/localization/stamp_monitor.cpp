#include "pipeline/localization/stamp_monitor.h"

#include <cmath>

#include <Eigen/LU>

#include "common/se2.h"

namespace bevloc {
namespace {

/// A row of the fit needs this change of the yaw rate.
constexpr double kTurning_radps = 0.05;
/// Rows that the fit remembers: some minutes of bends.
constexpr double kRemembered = 1000.0;
/// Rows until the first estimate: 3 s of bends.
constexpr double kFewest = 30.0;
/// Neighbouring rows share most of their lag, and errors of matches are correlated, so this many
/// rows count as one.
constexpr double kCorrelatedRows = 20.0;
/// Lower limit of the residual's standard deviation.
constexpr double kLeastResidual_rad = radians(0.05);
constexpr int kCertain = 3;  ///< sigmas
/// Standard deviations of the bias and of the scale error that are assumed before the fit.
constexpr double kBiasSigma_radps = radians(0.5);
constexpr double kScaleSigma = 0.03;

}  // namespace

void StampMonitor::reset() {
  rates_.clear();
  headings_.clear();
  sums_ = {};
  estimate_.reset();
  contradicts_ = false;
  wrong_offset_ = {};
}

void StampMonitor::note_gap() {
  if (!contradicts_) return reset();
  rates_.clear();
  headings_.clear();
  sums_ = {};
}

void StampMonitor::add_rate(Time time, double yaw_rate_radps) {
  if (rates_.empty()) {
    rates_.push_back({time, yaw_rate_radps, 0.0});
    return;
  }
  const Rate& latest = rates_.back();
  if (time <= latest.time) return;
  if (time - latest.time > kGap) {
    rates_.clear();
    headings_.clear();
    rates_.push_back({time, yaw_rate_radps, 0.0});
    return;
  }
  const double step_rad =
      0.5 * (latest.yaw_rate_radps + yaw_rate_radps) * to_seconds(time - latest.time);
  rates_.push_back({time, yaw_rate_radps, latest.heading_rad + step_rad});
}

std::optional<StampMonitor::Rate> StampMonitor::rate_at(Time time) const {
  if (rates_.empty() || time > rates_.back().time) return std::nullopt;
  for (size_t after = rates_.size() - 1; after > 0; --after) {
    const Rate& low = rates_[after - 1];
    const Rate& high = rates_[after];
    if (low.time > time) continue;
    const double share = to_seconds(time - low.time) / to_seconds(high.time - low.time);
    return Rate{time, std::lerp(low.yaw_rate_radps, high.yaw_rate_radps, share),
                std::lerp(low.heading_rad, high.heading_rad, share)};
  }
  return std::nullopt;
}

void StampMonitor::add_heading(Time time, double heading_rad) {
  if (!headings_.empty() && time - headings_.back().time < kSpacing) return;
  const auto rate = rate_at(time);
  if (!rate) return;
  Heading now{time, heading_rad - rate->heading_rad, rate->heading_rad, rate->yaw_rate_radps};
  if (!headings_.empty()) {
    const double before = headings_.back().difference_rad;
    now.difference_rad = before + wrap_angle(now.difference_rad - before);
  }
  while (!headings_.empty() && time - headings_.front().time > kLag) {
    const Heading before = headings_.front();
    headings_.pop_front();
    // Of the headings that are old enough, only the latest one is used.
    if (headings_.empty() || time - headings_.front().time <= kLag) fit(before, now);
  }
  headings_.push_back(now);
}

void StampMonitor::fit(const Heading& before, const Heading& now) {
  if (now.time - before.time > kLongestLag) return;
  const double change_radps = now.yaw_rate_radps - before.yaw_rate_radps;
  if (std::abs(change_radps) < kTurning_radps) return;
  const double change_rad = now.difference_rad - before.difference_rad;
  const Eigen::Vector3d row(to_seconds(now.time - before.time),
                            now.integrated_rad - before.integrated_rad, -change_radps);
  constexpr double kKeep = 1.0 - 1.0 / kRemembered;
  sums_.normal = kKeep * sums_.normal + row * row.transpose();
  sums_.right = kKeep * sums_.right + row * change_rad;
  sums_.square = kKeep * sums_.square + change_rad * change_rad;
  sums_.rows = kKeep * sums_.rows + 1.0;
  judge();
}

std::optional<StampMonitor::Estimate> StampMonitor::solve() const {
  if (sums_.rows < kFewest) return std::nullopt;
  const auto covariance_for = [this](double residual_variance) {
    Eigen::Matrix3d normal = sums_.normal;
    normal(0, 0) += residual_variance / (kBiasSigma_radps * kBiasSigma_radps);
    normal(1, 1) += residual_variance / (kScaleSigma * kScaleSigma);
    return Eigen::Matrix3d(normal.inverse());
  };
  double variance = kLeastResidual_rad * kLeastResidual_rad;
  const Eigen::Vector3d found = covariance_for(variance) * sums_.right;
  const double squares =
      sums_.square - 2.0 * found.dot(sums_.right) + found.dot(sums_.normal * found);
  variance = std::max(variance, squares / sums_.rows);
  const Eigen::Matrix3d inverse = covariance_for(variance);
  const double sigma_s = std::sqrt(kCorrelatedRows * variance * inverse(2, 2));
  return Estimate{from_seconds((inverse * sums_.right)(2)), from_seconds(sigma_s)};
}

void StampMonitor::judge() {
  const auto solved = solve();
  if (!solved) return;
  estimate_ = solved;
  const bool wrong = std::chrono::abs(solved->offset) - kCertain * solved->sigma > tolerated_;
  // Only what comes after a contradiction says whether the stamps are right again.
  if (wrong) {
    sums_ = {};
    wrong_offset_ = solved->offset;
  }
  contradicts_ = wrong || (contradicts_ && !agrees());
}

bool StampMonitor::agrees() const {
  return estimate_ &&
         std::chrono::abs(estimate_->offset) + kCertain * estimate_->sigma < tolerated_;
}

int StampMonitor::contradicting_ms() const {
  using std::chrono::duration_cast;
  using std::chrono::milliseconds;
  if (!contradicts_) return 0;
  return static_cast<int>(duration_cast<milliseconds>(wrong_offset_).count());
}

}  // namespace bevloc
