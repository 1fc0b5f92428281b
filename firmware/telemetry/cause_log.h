// Decides whether a repeated error is logged: once per cause.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/time.h"

namespace bevloc::firmware {

/// Remembers the causes of one source of errors, such as one camera or one GPIO line. A cause is
/// new if it did not occur within the last minute; an error that lasts or comes and goes is thus
/// logged once. One thread.
class CauseLog {
 public:
  static constexpr Duration kQuiet = std::chrono::minutes(1);
  /// The cause that occurred least recently is forgotten for another one.
  static constexpr size_t kCauses = 8;

  /// Notes that `cause`, which is not empty, occurred at `now`. True if it is new.
  bool is_new(std::string_view cause, Time now) {
    Entry* oldest = &entries_.front();
    for (Entry& entry : entries_) {
      if (entry.cause == cause) {
        const bool was_quiet = now - entry.time >= kQuiet;
        entry.time = now;
        return was_quiet;
      }
      if (entry.time < oldest->time) oldest = &entry;
    }
    *oldest = {std::string(cause), now};
    return true;
  }

 private:
  struct Entry {
    std::string cause;
    Time time = Time::min();
  };
  std::array<Entry, kCauses> entries_;
};

}  // namespace bevloc::firmware
