#include "drivers/frameset/rate_monitor.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace bevloc::drivers {
namespace {

constexpr int kFramesBetweenFits = 32;
/// The longest pause, in periods. After a longer one the number of missed frames is uncertain.
constexpr int kLongestPausePeriods = 10;
constexpr double kSigmas = 3.0;
/// The lower bound of the jitter, because no time stamp is more accurate.
constexpr double kLeastJitter_s = 1e-6;

}  // namespace

bool CameraDrift::certain() const {
  return std::abs(ppm) - kSigmas * sigma_ppm > RateMonitor::kLimit_ppm;
}

void RateMonitor::add(int camera, Time time) {
  Track& track = tracks_[camera];
  if (track.period &&
      to_seconds(time - track.times.back()) > kLongestPausePeriods * track.period->seconds) {
    track.times.clear();
    track.period.reset();
  }
  track.times.push_back(time);
  if (++track.frames_since_fit < kFramesBetweenFits) return;
  track.frames_since_fit = 0;
  track.period = fit(track);
  compare();
}

/// Fits frame time over frame number by least squares.
std::optional<RateMonitor::Period> RateMonitor::fit(const Track& track) {
  const boost::circular_buffer<Time>& times = track.times;
  const auto size = static_cast<int>(times.size());
  if (size < kFewest) return std::nullopt;
  const auto intervals = std::span(intervals_).first(size - 1);
  for (int i = 1; i < size; ++i) intervals[i - 1] = times[i] - times[i - 1];
  const auto middle = intervals.begin() + size / 2;
  std::ranges::nth_element(intervals, middle);
  const double typical_s = to_seconds(*middle);

  const double n = size;
  double number = 0.0;
  double sum_k = 0.0, sum_t = 0.0, sum_kk = 0.0, sum_kt = 0.0, sum_tt = 0.0;
  for (int i = 0; i < size; ++i) {
    if (i > 0) {
      const double interval_s = to_seconds(times[i] - times[i - 1]);
      number += std::max(1.0, std::round(interval_s / typical_s));
    }
    const double t = to_seconds(times[i] - times[0]);
    sum_k += number;
    sum_t += t;
    sum_kk += number * number;
    sum_kt += number * t;
    sum_tt += t * t;
  }
  const double k_spread = sum_kk - sum_k * sum_k / n;
  const double k_with_t = sum_kt - sum_k * sum_t / n;
  const double t_spread = sum_tt - sum_t * sum_t / n;
  const double slope = k_with_t / k_spread;
  const double jitter_s = std::sqrt(std::max(0.0, (t_spread - slope * k_with_t) / (n - 2.0)));
  // If there is more jitter, the frames have no steady rate, or some intervals were counted
  // wrongly.
  if (!(slope > 0.0) || 4.0 * jitter_s > slope) return std::nullopt;
  return Period{slope, std::max(jitter_s, kLeastJitter_s) / std::sqrt(k_spread)};
}

void RateMonitor::compare() {
  std::array<Period, kCameraCount> known{};
  int count = 0;
  for (const Track& track : tracks_) {
    if (track.period) known[count++] = *track.period;
  }
  drifts_ = {};
  if (count < kFewestCameras) return;
  const auto median = known.begin() + count / 2;
  std::nth_element(known.begin(), median, known.begin() + count,
                   [](const Period& a, const Period& b) { return a.seconds < b.seconds; });
  for (int i = 0; i < kCameraCount; ++i) {
    const std::optional<Period>& own = tracks_[i].period;
    if (!own) continue;
    const double sigma = std::hypot(own->sigma / own->seconds, median->sigma / median->seconds);
    drifts_[i] = CameraDrift{1e6 * (median->seconds / own->seconds - 1.0), 1e6 * sigma};
  }
}

}  // namespace bevloc::drivers
