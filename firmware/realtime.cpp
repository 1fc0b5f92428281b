#include "firmware/realtime.h"

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

/// Under a finite limit memory could be locked now and the next allocation fail. So the limit
/// becomes unlimited or, where that is not allowed, zero: then the kernel says yes only to the
/// capability that no limit holds for.
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

Status run_fifo(std::string_view role, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error == 0) return {};
  return fail(
      "realtime.{}.fifo_priority: found no permission for {} ({}), wanted LimitRTPRIO={} "
      "(ulimit -r {}) and no RestrictRealtime=, or CAP_SYS_NICE",
      role, priority, std::strerror(error), priority, priority);
}

Status run_on(std::string_view role, const std::vector<int>& cpus) {
  cpu_set_t wanted;
  CPU_ZERO(&wanted);
  for (const int cpu : cpus) CPU_SET(static_cast<size_t>(cpu), &wanted);
  cpu_set_t granted;
  CPU_ZERO(&granted);
  if (pthread_setaffinity_np(pthread_self(), sizeof wanted, &wanted) == 0) {
    pthread_getaffinity_np(pthread_self(), sizeof granted, &granted);
  }
  // The kernel leaves out, without a word, what the thread may not use.
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
    if (!settings.cpus.empty()) note(run_on(role_name, settings.cpus));
    if (settings.fifo_priority) note(run_fifo(role_name, *settings.fifo_priority));
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

}  // namespace bevloc::firmware
