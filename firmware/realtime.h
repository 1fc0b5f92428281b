// Asks the kernel for what the configuration's section `realtime` wants, and counts what it
// refuses.
#pragma once

#include <cstdint>
#include <mutex>
#include <set>
#include <string>

#include "common/result.h"
#include "firmware/realtime_config.h"

namespace bevloc::firmware {

enum class ThreadRole : uint8_t { kCapture, kVision, kCan };

/// What is refused is no reason not to run: it is logged as a warning, once, with what would permit
/// it, and counted. Thread safe.
class Realtime {
 public:
  explicit Realtime(RealtimeConfig config) : config_(std::move(config)) {}

  /// Of the whole process, if that is configured: what was touched once stays in memory. Pages are
  /// locked as they are touched, not the whole of every library and 8 MiB for every stack.
  void lock_memory();

  /// To be called first in a thread of that role. Threads that it starts inherit the settings.
  void begin_thread(ThreadRole role, const std::string& name);

  /// Settings that the kernel refused; one of a role counts once, however many threads it has.
  int refusals() const;

 private:
  void note(const Status& status);

  const RealtimeConfig config_;
  mutable std::mutex mutex_;
  std::set<std::string> refusals_;
};

/// What `top -H` shows: at most 15 characters.
void name_this_thread(const std::string& name);

}  // namespace bevloc::firmware
