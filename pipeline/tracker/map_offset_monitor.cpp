#include "pipeline/tracker/map_offset_monitor.h"

#include <cmath>

#include "pipeline/tracker/motion_model.h"

namespace bevloc {
namespace {

constexpr Duration kPeriod = std::chrono::seconds(1);
/// Sigma of the offset before anything is known, per axis.
constexpr double kPriorSigma_m = 5.0;
/// Growth of the offset, because a map has another offset from one road to the next.
constexpr double kGrowth_m_per_sqrt_s = 0.003;
/// Sigma of the errors of the pose and of the noise of GNSS together.
constexpr double kScatter_m = 0.4;
/// A sample with a larger squared distance is not used.
constexpr double kOutlier = 16.0;
/// If all samples are outliers for this many correlation times, the cause is not an error of GNSS.
constexpr double kLongestErrors = 5.0;
/// An offset matters above kMatters_m, and from then on until it is below kHarmless_m.
constexpr double kMatters_m = 0.75;
constexpr double kHarmless_m = 0.5;
/// Squared offset in units of its variance, for two axes. By chance, one in 20,000 independent
/// estimates exceeds it.
constexpr double kCertain = 20.0;

}  // namespace

void MapOffsetMonitor::predict(double elapsed_s, double sigma_m) {
  const double kept = std::exp(-elapsed_s / correlation_s_);
  offset_variance_ += elapsed_s * square_of(kGrowth_m_per_sqrt_s);
  error_m_ *= kept;
  common_variance_ *= kept;
  error_variance_ =
      square_of(kept) * error_variance_ + (1.0 - square_of(kept)) * square_of(sigma_m);
}

void MapOffsetMonitor::add(Time time, const Eigen::Vector2d& difference_m, double sigma_m) {
  if (latest_ && time - *latest_ < kPeriod) return;
  if (!latest_) {
    offset_variance_ = square_of(kPriorSigma_m);
    error_variance_ = square_of(sigma_m);
  } else {
    predict(to_seconds(time - *latest_), sigma_m);
  }
  latest_ = time;

  const Eigen::Vector2d innovation_m = difference_m - offset_m_ - error_m_;
  const double with_offset = offset_variance_ + common_variance_;
  const double with_error = error_variance_ + common_variance_;
  const double variance = with_offset + with_error + square_of(kScatter_m);
  if (innovation_m.squaredNorm() > kOutlier * variance) return note_outlier();
  outliers_in_a_row_ = 0;
  offset_m_ += innovation_m * (with_offset / variance);
  error_m_ += innovation_m * (with_error / variance);
  offset_variance_ -= square_of(with_offset) / variance;
  error_variance_ -= square_of(with_error) / variance;
  common_variance_ -= with_offset * with_error / variance;
  judge();
}

/// An error of GNSS does not last as long as kLongestErrors, so the offset itself has changed.
void MapOffsetMonitor::note_outlier() {
  if (++outliers_in_a_row_ * to_seconds(kPeriod) < kLongestErrors * correlation_s_) return;
  offset_variance_ = square_of(kPriorSigma_m);
  outliers_in_a_row_ = 0;
}

void MapOffsetMonitor::judge() {
  if (contradicts_) {
    contradicts_ = offset_m_.norm() > kHarmless_m;
  } else {
    contradicts_ =
        offset_m_.norm() > kMatters_m && offset_m_.squaredNorm() > kCertain * offset_variance_;
  }
}

}  // namespace bevloc
