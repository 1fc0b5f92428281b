// Applies the section `realtime` of the configuration: locked memory, priorities and CPUs.
#pragma once

#include <cstdint>
#include <mutex>
#include <set>
#include <string>

#include "common/result.h"
#include "firmware/config/realtime_config.h"

namespace bevloc::firmware {

enum class ThreadRole : uint8_t { kCapture, kVision, kCan };

/// Applies the settings. If the kernel refuses one, the appliance runs without it. Each refusal is
/// counted, and logged once as a warning that names the missing permission. Thread-safe.
class Realtime {
 public:
  explicit Realtime(RealtimeConfig config) : config_(std::move(config)) {}

  /// Locks the memory of the whole process, if configured. A page is locked when it is first
  /// touched (MCL_ONFAULT), so untouched parts of libraries and stacks (8 MiB each) cost no memory.
  void lock_memory();

  /// Names the calling thread and applies the settings of its role. Threads that it starts later
  /// inherit them.
  void begin_thread(ThreadRole role, const std::string& name);

  /// Number of refused settings. A setting counts once per role, not per thread.
  int refusals() const;

 private:
  void note(const Status& status);

  const RealtimeConfig config_;
  mutable std::mutex mutex_;
  std::set<std::string> refusals_;  ///< messages of the refusals
};

/// Sets the calling thread's name, which `top -H` shows: at most 15 characters.
void name_this_thread(const std::string& name);

/// Names the calling thread and gives it the lowest priority of the normal scheduler, so that it
/// slows no stage down. If the kernel refuses, the thread keeps its priority.
void begin_low_thread(const std::string& name);

}  // namespace bevloc::firmware
