// What the section `realtime` of the configuration file says.
#pragma once

#include <optional>
#include <vector>

#include "common/strict_yaml.h"

namespace bevloc::firmware {

/// Interrupt threads run at 50 and must not wait for bevloc. systemd/bevlocd.service permits as
/// much.
inline constexpr int kMaxFifoPriority = 49;

/// What threads of one role ask of the kernel's scheduler.
struct ThreadSettings {
  std::optional<int> fifo_priority;  ///< of SCHED_FIFO; none: the scheduler of all other programs
  std::vector<int> cpus;             ///< growing; empty: where the kernel likes
};

/// Asks for nothing by default, so that bevloc runs anywhere and as any user.
struct RealtimeConfig {
  bool lock_memory = false;
  ThreadSettings capture;  ///< a thread per camera, and the trigger's
  ThreadSettings vision;
  ThreadSettings can;  ///< CAN in and CAN out
};

/// CPUs are those of this machine. Mistakes are reported by the file's YamlMap::finish().
RealtimeConfig read_realtime(std::optional<YamlMap> yaml);

}  // namespace bevloc::firmware
