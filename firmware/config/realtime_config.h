// The section `realtime` of the configuration file.
#pragma once

#include <optional>
#include <vector>

#include "common/strict_yaml.h"

namespace bevloc::firmware {

/// The highest priority of bevloc, which systemd/bevlocd.service permits. The kernel's interrupt
/// threads have priority 50 and must not wait for bevloc.
inline constexpr int kMaxFifoPriority = 49;

/// Scheduling of the threads of one role.
struct ThreadSettings {
  std::optional<int> fifo_priority;  ///< priority of SCHED_FIFO; nothing for the normal scheduler
  std::vector<int> cpus;             ///< sorted; empty for all CPUs
};

/// By default nothing is requested, so that bevloc runs anywhere and as any user.
struct RealtimeConfig {
  bool lock_memory = false;
  ThreadSettings capture;  ///< the threads of the cameras and the trigger
  ThreadSettings vision;
  ThreadSettings can;  ///< the threads CAN in and CAN out
};

/// Reads the section. The CPUs must exist on this machine. YamlMap::finish() reports mistakes.
RealtimeConfig read_realtime(std::optional<YamlMap> yaml);

}  // namespace bevloc::firmware
