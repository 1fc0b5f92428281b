// Decides whether a repeated error is logged: once per cause.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/time.h"

namespace bevloc::firmware {

/// Remembers the causes of one source of errors, such as one camera or one GPIO line. A cause is
/// new if it did not occur within the last minute. So an error that lasts, or comes and goes, is
/// logged once. An error that comes back within the minute is logged again after it has lasted for
/// kLasting. Without this, a camera that recovers and then dies for good would leave "recovered" as
/// its last line. One thread.
class CauseLog {
 public:
  static constexpr Duration kQuiet = std::chrono::minutes(1);
  /// An error that lasts occurs at least this often.
  static constexpr Duration kPause = std::chrono::seconds(3);
  static constexpr Duration kLasting = std::chrono::seconds(5);
  /// The number of causes that are remembered. A further one replaces the cause that occurred least
  /// recently.
  static constexpr size_t kCauses = 8;

  /// Notes that `cause`, which is not empty, occurred at `now`. Returns true if it is new.
  bool is_new(std::string_view cause, Time now) {
    Entry* oldest = &entries_.front();
    for (Entry& entry : entries_) {
      if (entry.cause == cause) return note(entry, now);
      if (entry.time < oldest->time) oldest = &entry;
    }
    *oldest = {std::string(cause), now, now, true};
    return true;
  }

 private:
  struct Entry {
    std::string cause;
    Time time = Time::min();   ///< time of the latest occurrence
    Time since = Time::min();  ///< time of the first occurrence without a pause after it
    bool told = false;         ///< whether it was reported as new since then
  };

  static bool note(Entry& entry, Time now) {
    const Duration pause = now - entry.time;
    entry.time = now;
    if (pause > kPause) {
      entry.since = now;
      entry.told = false;
    }
    const bool is_new = !entry.told && (pause >= kQuiet || now - entry.since >= kLasting);
    entry.told = entry.told || is_new;
    return is_new;
  }

  std::array<Entry, kCauses> entries_;
};

}  // namespace bevloc::firmware
