#include "firmware/threads/realtime.h"

#include <cassert>
#include <cerrno>
#include <cstring>
#include <string_view>

#include <fmt/ranges.h>
#include <pthread.h>
#include <sched.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/resource.h>

namespace bevloc::firmware {
namespace {

constexpr int kLowestPriority = 19;

/// Locks all memory. Under a finite limit, locking could succeed now and a later allocation fail.
/// So the soft limit is set to unlimited if the hard limit allows it, and otherwise to 0. With the
/// limit 0, mlockall() succeeds only with CAP_IPC_LOCK.
Status lock_all_memory() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  const rlimit before = limit;
  limit.rlim_cur = limit.rlim_max == RLIM_INFINITY ? RLIM_INFINITY : 0;
  setrlimit(RLIMIT_MEMLOCK, &limit);
  if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0) return {};
  const int error = errno;
  setrlimit(RLIMIT_MEMLOCK, &before);
  return fail(
      "realtime.lock_memory: found no permission ({}), wanted LimitMEMLOCK=infinity (ulimit -l "
      "unlimited) or CAP_IPC_LOCK",
      std::strerror(error));
}

/// Sets SCHED_FIFO with this priority for the calling thread.
Status set_fifo_priority(std::string_view role, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error == 0) return {};
  return fail(
      "realtime.{}.fifo_priority: found no permission for {} ({}), wanted LimitRTPRIO={} "
      "(ulimit -r {}) and no RestrictRealtime=, or CAP_SYS_NICE",
      role, priority, std::strerror(error), priority, priority);
}

/// Restricts the calling thread to these CPUs.
Status set_cpus(std::string_view role, const std::vector<int>& cpus) {
  cpu_set_t wanted;
  CPU_ZERO(&wanted);
  for (const int cpu : cpus) CPU_SET(static_cast<size_t>(cpu), &wanted);
  cpu_set_t granted;
  CPU_ZERO(&granted);
  if (pthread_setaffinity_np(pthread_self(), sizeof wanted, &wanted) == 0) {
    pthread_getaffinity_np(pthread_self(), sizeof granted, &granted);
  }
  // The kernel silently ignores CPUs that the thread may not use.
  if (CPU_EQUAL(&wanted, &granted)) return {};
  return fail(
      "realtime.{}.cpus: found {} of the CPUs {} usable, wanted all online and allowed "
      "(AllowedCPUs=, cpusets)",
      role, CPU_COUNT(&granted), fmt::join(cpus, ", "));
}

}  // namespace

void Realtime::lock_memory() {
  if (config_.lock_memory) note(lock_all_memory());
}

void Realtime::begin_thread(ThreadRole role, const std::string& name) {
  name_this_thread(name);
  const auto apply = [this](std::string_view role_name, const ThreadSettings& settings) {
    if (!settings.cpus.empty()) note(set_cpus(role_name, settings.cpus));
    if (settings.fifo_priority) note(set_fifo_priority(role_name, *settings.fifo_priority));
  };
  switch (role) {
    case ThreadRole::kCapture:
      return apply("capture", config_.capture);
    case ThreadRole::kVision:
      return apply("vision", config_.vision);
    case ThreadRole::kCan:
      return apply("can", config_.can);
  }
}

int Realtime::refusals() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(refusals_.size());
}

void Realtime::note(const Status& status) {
  if (status) return;
  const std::lock_guard lock(mutex_);
  if (refusals_.insert(status.error().message).second) spdlog::warn(status.error().message);
}

void name_this_thread(const std::string& name) {
  assert(name.size() <= 15);
  pthread_setname_np(pthread_self(), name.c_str());
}

void begin_low_thread(const std::string& name) {
  name_this_thread(name);
  // On Linux this changes the priority of the calling thread only.
  (void)setpriority(PRIO_PROCESS, 0, kLowestPriority);
}

}  // namespace bevloc::firmware
