#include "drivers/gnss/fix_clock.h"

#include <algorithm>

namespace bevloc::drivers {
namespace {

constexpr Duration kBucket = std::chrono::seconds(5);
/// If UTC goes back by more than this, the receiver's time has started anew.
constexpr Duration kRestart = std::chrono::seconds(1);
/// A delay that grows by at least this much shows that UTC may have been set back by a leap second:
/// the next report then seems to be delayed by one second more. Delays also vary without that, but
/// by less than 300 ms.
constexpr Duration kSetBack = std::chrono::milliseconds(700);
/// UTC counts as set back only if all reports of such an interval say so. A few old reports do not
/// suffice.
constexpr Duration kSetBackTime = std::chrono::seconds(1);
constexpr Duration kLeastSigma = std::chrono::milliseconds(1);

}  // namespace

FixTime FixClock::judge(std::chrono::nanoseconds utc, const FixArrival& arrival) {
  const Report report{.utc = utc, .delay = arrival.unsteered - utc};
  if (latest_) {
    if (latest_->utc - utc > kRestart || is_set_back(report, arrival.time)) {
      buckets_ = {};
      learned_ = 0;
      set_back_since_.reset();
    } else if (utc <= latest_->utc) {
      return {FixVerdict::kRepeated};
    } else if (set_back_since_) {
      return {FixVerdict::kLearning};
    }
  }
  latest_ = report;
  return parameters_.timing == FixTiming::kArrival ? by_arrival(report.delay, arrival)
                                                   : by_system_clock(utc, arrival);
}

bool FixClock::is_set_back(const Report& report, Time arrival) {
  if (parameters_.timing != FixTiming::kArrival) return false;
  if (report.delay - latest_->delay < kSetBack) {
    set_back_since_.reset();
    return false;
  }
  if (!set_back_since_ && report.utc < latest_->utc) set_back_since_ = arrival;
  return set_back_since_ && arrival - *set_back_since_ >= kSetBackTime;
}

FixTime FixClock::by_arrival(Duration delay, const FixArrival& arrival) {
  const Duration later_than_fastest =
      std::max(delay - least_delay(delay, arrival.time), Duration::zero());
  learned_ = std::min(learned_ + 1, kLearned);
  const Duration age = parameters_.latency + later_than_fastest;
  if (age > parameters_.max_age) return {FixVerdict::kStale};
  if (learned_ < kLearned) return {FixVerdict::kLearning};
  return usable(age, parameters_.latency_sigma, arrival.time);
}

FixTime FixClock::by_system_clock(std::chrono::nanoseconds utc, const FixArrival& arrival) {
  const ClockDiscipline& clock = arrival.wall.discipline;
  if (!clock.synchronized || clock.max_error > kMaxClockError) {
    return {FixVerdict::kUnsynchronized};
  }
  const Duration age = arrival.wall.since_1970 - utc;
  if (age > parameters_.max_age) return {FixVerdict::kStale};
  if (age < -clock.max_error) return {FixVerdict::kFuture};
  // The bound counts as three standard deviations.
  return usable(std::max(age, Duration::zero()), std::max(clock.max_error / 3, kLeastSigma),
                arrival.time);
}

Duration FixClock::least_delay(Duration delay, Time arrival) {
  const int64_t number = arrival.time_since_epoch() / kBucket;
  const auto count = static_cast<int64_t>(buckets_.size());
  Bucket& own = buckets_[static_cast<size_t>(number % count)];
  if (own.number != number) own = {.number = number};
  own.second = std::min(own.second, std::max(own.least, delay));
  own.least = std::min(own.least, delay);
  Duration least = delay;
  Duration confirmed = Duration::max();
  for (const Bucket& bucket : buckets_) {
    if (bucket.number <= number - count) continue;
    least = std::min(least, bucket.least);
    confirmed = std::min(confirmed, bucket.second);
  }
  return confirmed == Duration::max() ? least : confirmed;
}

FixTime FixClock::usable(Duration age, Duration sigma, Time arrival) {
  max_usable_age_ = std::max(max_usable_age_, age);
  return {FixVerdict::kUsable, arrival - age, sigma};
}

}  // namespace bevloc::drivers
