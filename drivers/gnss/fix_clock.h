// Finds out for which moment, on the steady clock, a GNSS position holds.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "common/time.h"
#include "drivers/clock/clock_discipline.h"

namespace bevloc::drivers {

/// How the time of a fix is found.
enum class FixTiming : uint8_t {
  /// The age of a fix at its arrival is `latency` plus the extra delay of its report. The extra
  /// delay is how much longer the report took, by the receiver's UTC, than the fast reports of the
  /// last minutes.
  kArrival,
  /// The system clock is UTC, as the kernel confirms, so the age of a fix is known.
  kSystemClock,
};

struct FixClockParameters {
  FixTiming timing = FixTiming::kArrival;
  Duration latency{};  ///< latency and latency_sigma are used for kArrival only
  Duration latency_sigma = std::chrono::milliseconds(50);
  Duration max_age = std::chrono::seconds(1);  ///< an older fix is stale
};

/// When a report arrived, on three clocks.
struct FixArrival {
  Time time{};
  Duration unsteered{};  ///< Clock::unsteered()
  WallTime wall;
};

enum class FixVerdict : uint8_t {
  kUsable,
  kLearning,        ///< kArrival: there were too few reports to know how fast they can be, or UTC
                    ///< may just have been set back
  kRepeated,        ///< not newer than the fix before it
  kStale,           ///< older than max_age
  kFuture,          ///< kSystemClock: newer than the system clock permits
  kUnsynchronized,  ///< kSystemClock: the clock is not synchronized, or may be too far off
};
inline constexpr size_t kFixVerdicts = 6;

struct FixTime {
  FixVerdict verdict = FixVerdict::kLearning;
  Time time{};       ///< the moment of the fix; valid for kUsable only, like sigma
  Duration sigma{};  ///< one standard deviation of `time`
};

/// Does not allocate. One thread.
class FixClock {
 public:
  /// With kArrival, the fix of this number is the first one that is used.
  static constexpr int kLearned = 3;
  /// With kSystemClock the kernel's bound of the clock's error may be this large.
  static constexpr Duration kMaxClockError = std::chrono::milliseconds(100);

  explicit FixClock(const FixClockParameters& parameters) : parameters_(parameters) {}

  /// `utc` is the time that the receiver gives for the fix. Fixes must come in the order of their
  /// arrival.
  FixTime judge(std::chrono::nanoseconds utc, const FixArrival& arrival);

  /// The largest age of a fix that was usable, by kSystemClock or as far as kArrival can tell.
  Duration max_usable_age() const { return max_usable_age_; }

 private:
  /// The delays of the two fastest reports of some seconds. A delay is the arrival, on the
  /// unsteered clock, minus UTC.
  struct Bucket {
    int64_t number = std::numeric_limits<int64_t>::min();
    Duration least = Duration::max();
    Duration second = Duration::max();
  };

  struct Report {
    std::chrono::nanoseconds utc{};
    Duration delay{};
  };

  /// Returns whether the receiver has set back its UTC for good, by about a leap second. A slow
  /// network or gpsd only delays the reports, and UTC does not go back. Then the learned delays
  /// stay valid.
  bool is_set_back(const Report& report, Time arrival);
  FixTime by_arrival(Duration delay, const FixArrival& arrival);
  FixTime by_system_clock(std::chrono::nanoseconds utc, const FixArrival& arrival);
  /// Returns the smallest Bucket::second of the last minutes, so that a single report with a wrong
  /// UTC does not shift all others. If each bucket has one report only, returns the smallest delay.
  Duration least_delay(Duration delay, Time arrival);
  FixTime usable(Duration age, Duration sigma, Time arrival);

  FixClockParameters parameters_;
  /// The latest report, except for those that repeated an earlier time or came while UTC seemed to
  /// be set back.
  std::optional<Report> latest_;
  std::optional<Time> set_back_since_;  ///< first arrival at which UTC seemed to be set back
  std::array<Bucket, 64> buckets_{};    ///< for five minutes
  int learned_ = 0;
  Duration max_usable_age_{};
};

}  // namespace bevloc::drivers
