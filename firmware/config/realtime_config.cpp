#include "firmware/config/realtime_config.h"

#include <algorithm>

#include <unistd.h>

namespace bevloc::firmware {
namespace {

/// Counts offline CPUs, too, because they may come online later.
int cpu_count() {
  return static_cast<int>(sysconf(_SC_NPROCESSORS_CONF));
}

std::vector<int> read_cpus(YamlMap& yaml) {
  if (!yaml.has("cpus")) return {};
  auto cpu_of_this_machine = between(0, cpu_count() - 1);
  cpu_of_this_machine.limits.high.reset();  // The schema is for other machines too.
  std::vector<int> cpus = yaml.require_list<int>("cpus", 0, cpu_of_this_machine);
  std::ranges::sort(cpus);
  if (cpus.empty()) yaml.reject("cpus", "an empty list", "one CPU or more, or no key cpus");
  if (std::ranges::adjacent_find(cpus) != cpus.end()) {
    yaml.reject("cpus", "a CPU listed twice", "each CPU once");
  }
  return cpus;
}

ThreadSettings read_thread(std::optional<YamlMap> yaml) {
  ThreadSettings settings;
  if (!yaml) return settings;
  if (yaml->has("fifo_priority")) {
    settings.fifo_priority = yaml->require<int>("fifo_priority", between(1, kMaxFifoPriority));
  }
  settings.cpus = read_cpus(*yaml);
  return settings;
}

}  // namespace

RealtimeConfig read_realtime(std::optional<YamlMap> yaml) {
  RealtimeConfig realtime;
  if (!yaml) return realtime;
  realtime.lock_memory = yaml->optional<bool>("lock_memory", realtime.lock_memory);
  realtime.capture = read_thread(yaml->optional_map("capture"));
  realtime.vision = read_thread(yaml->optional_map("vision"));
  realtime.can = read_thread(yaml->optional_map("can"));
  return realtime;
}

}  // namespace bevloc::firmware
