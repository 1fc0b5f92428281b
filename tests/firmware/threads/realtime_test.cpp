#include "firmware/threads/realtime.h"

#include <cstdlib>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include "tests/firmware/log_capture.h"
#include "tests/support/capabilities.h"

namespace bevloc::firmware {
namespace {

using test::drop_capabilities;
using testing::HasSubstr;

/// A CPU number that no machine has.
constexpr int kNoCpu = CPU_SETSIZE - 1;

/// Runs `work` in a new thread, so that the settings of the test's thread do not change.
template <typename Work>
void in_new_thread(Work work) {
  std::jthread(work).join();
}

std::vector<int> cpus_of_this_thread() {
  cpu_set_t set;
  CPU_ZERO(&set);
  EXPECT_EQ(pthread_getaffinity_np(pthread_self(), sizeof set, &set), 0);
  std::vector<int> cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(static_cast<size_t>(cpu), &set)) cpus.push_back(cpu);
  }
  return cpus;
}

std::string name_of_this_thread() {
  char name[16] = {};
  EXPECT_EQ(pthread_getname_np(pthread_self(), name, sizeof name), 0);
  return name;
}

class RealtimeTest : public testing::Test {
 protected:
  LogCapture log_;
};

TEST_F(RealtimeTest, SettingsThatAreNotConfiguredDoNotChange) {
  const std::vector<int> cpus = cpus_of_this_thread();
  const int scheduler = sched_getscheduler(0);
  Realtime realtime{{}};
  realtime.lock_memory();
  in_new_thread([&] {
    realtime.begin_thread(ThreadRole::kCapture, "cam-front_right");
    EXPECT_EQ(name_of_this_thread(), "cam-front_right");
    EXPECT_EQ(cpus_of_this_thread(), cpus);
    EXPECT_EQ(sched_getscheduler(0), scheduler);
  });
  EXPECT_EQ(realtime.refusals(), 0);
  EXPECT_EQ(log_.text(), "");
}

TEST_F(RealtimeTest, EachRoleHasItsOwnCpus) {
  const std::vector<int> cpus = cpus_of_this_thread();
  RealtimeConfig config;
  config.vision.cpus = {cpus.front()};
  config.can.cpus = {cpus.back()};
  Realtime realtime(config);
  const auto cpus_as = [&realtime](ThreadRole role) {
    std::vector<int> found;
    in_new_thread([&] {
      realtime.begin_thread(role, "thread");
      found = cpus_of_this_thread();
    });
    return found;
  };
  EXPECT_EQ(cpus_as(ThreadRole::kCapture), cpus);
  EXPECT_EQ(cpus_as(ThreadRole::kVision), config.vision.cpus);
  EXPECT_EQ(cpus_as(ThreadRole::kCan), config.can.cpus);
  EXPECT_EQ(realtime.refusals(), 0);
}

TEST_F(RealtimeTest, UnusableCpusAreLoggedOnce) {
  const int cpu = cpus_of_this_thread().front();
  RealtimeConfig config;
  config.capture.cpus = {cpu, kNoCpu};
  config.can.cpus = {kNoCpu};
  Realtime realtime(config);
  for (int camera = 0; camera < 6; ++camera) {
    in_new_thread([&] {
      realtime.begin_thread(ThreadRole::kCapture, "camera");
      EXPECT_EQ(cpus_of_this_thread(), std::vector{cpu}) << "the usable CPU is set";
    });
  }
  EXPECT_EQ(realtime.refusals(), 1);
  EXPECT_EQ(log_.text(),
            fmt::format("warning: realtime.capture.cpus: found 1 of the CPUs {}, {} usable, "
                        "wanted all online and allowed (AllowedCPUs=, cpusets)\n",
                        cpu, kNoCpu));
  in_new_thread([&] { realtime.begin_thread(ThreadRole::kCan, "can"); });
  EXPECT_EQ(realtime.refusals(), 2);
  EXPECT_THAT(log_.text(), HasSubstr("realtime.can.cpus: found 0 of"));
}

/// Whether the kernel grants a thread of this process this priority.
bool may_have_priority(int priority) {
  int error = 0;
  in_new_thread([&] {
    sched_param parameters{};
    parameters.sched_priority = priority;
    error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  });
  return error == 0;
}

TEST_F(RealtimeTest, APriorityIsSetOrCountedAsRefused) {
  constexpr int kPriority = 3;
  const bool granted = may_have_priority(kPriority);
  RealtimeConfig config;
  config.can.fifo_priority = kPriority;
  Realtime realtime(config);
  in_new_thread([&] {
    realtime.begin_thread(ThreadRole::kCan, "can");
    sched_param parameters{};
    ASSERT_EQ(sched_getparam(0, &parameters), 0);
    EXPECT_EQ(sched_getscheduler(0), granted ? SCHED_FIFO : SCHED_OTHER);
    EXPECT_EQ(parameters.sched_priority, granted ? kPriority : 0);
  });
  EXPECT_EQ(realtime.refusals(), granted ? 0 : 1);
}

TEST_F(RealtimeTest, ARefusedPriorityIsLoggedOnceWithTheMissingPermission) {
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_RTPRIO, &limit), 0);
  const rlimit none{0, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_RTPRIO, &none), 0);
  RealtimeConfig config;
  config.capture.fifo_priority = 7;
  Realtime realtime(config);
  for (int camera = 0; camera < 6; ++camera) {
    in_new_thread([&] {
      drop_capabilities();
      realtime.begin_thread(ThreadRole::kCapture, "camera");
      EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
    });
  }
  setrlimit(RLIMIT_RTPRIO, &limit);
  EXPECT_EQ(realtime.refusals(), 1);
  EXPECT_EQ(log_.text(),
            "warning: realtime.capture.fifo_priority: found no permission for 7 (Operation not "
            "permitted), wanted LimitRTPRIO=7 (ulimit -r 7) and no RestrictRealtime=, or "
            "CAP_SYS_NICE\n");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they disable mlockall()

/// Returns the value of a line of /proc/self/status, in kB.
long status_kb(const std::string& key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(key + ":")) return std::atol(line.c_str() + key.size() + 1);
  }
  return -1;
}

Realtime locking() {
  RealtimeConfig config;
  config.lock_memory = true;
  return Realtime(config);
}

/// Whether the kernel lets this process lock its memory without a finite limit. With the limit 0,
/// it does so only for a process with CAP_IPC_LOCK.
bool may_lock_memory() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  const rlimit before = limit;
  limit.rlim_cur = limit.rlim_max == RLIM_INFINITY ? RLIM_INFINITY : 0;
  setrlimit(RLIMIT_MEMLOCK, &limit);
  const bool may = mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;
  munlockall();
  setrlimit(RLIMIT_MEMLOCK, &before);
  return may;
}

/// Locks memory and exits with 0 if only touched pages are locked, or if the kernel had to refuse.
/// Runs as a death test, because the memory stays locked.
[[noreturn]] void lock_and_exit() {
  const bool may = may_lock_memory();
  Realtime realtime = locking();
  realtime.lock_memory();
  if (realtime.refusals() != (may ? 0 : 1)) std::exit(1);
  if (!may) std::exit(status_kb("VmLck") == 0 ? 0 : 1);
  const long before_kb = status_kb("VmRSS");
  constexpr size_t kStack = size_t{64} << 20U;
  void* const fresh =
      mmap(nullptr, kStack, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  const bool locked = fresh != MAP_FAILED && status_kb("VmLck") >= long{kStack >> 10U};
  const bool untouched_is_not_there = status_kb("VmRSS") - before_kb < long{kStack >> 11U};
  std::exit(locked && untouched_is_not_there ? 0 : 1);
}

[[noreturn]] void be_refused_and_exit() {
  const rlimit small{4096, 8192};
  setrlimit(RLIMIT_MEMLOCK, &small);
  drop_capabilities();
  Realtime realtime = locking();
  realtime.lock_memory();
  rlimit after{};
  getrlimit(RLIMIT_MEMLOCK, &after);
  const bool as_before = after.rlim_cur == small.rlim_cur && status_kb("VmLck") == 0;
  std::exit(realtime.refusals() == 1 && as_before ? 0 : 1);
}

TEST_F(RealtimeTest, OnlyTouchedPagesAreLocked) {
  EXPECT_EXIT(lock_and_exit(), testing::ExitedWithCode(0), "");
}

TEST_F(RealtimeTest, WithAFiniteLimitNothingIsLocked) {
  EXPECT_EXIT(be_refused_and_exit(), testing::ExitedWithCode(0), "");
}

#endif

}  // namespace
}  // namespace bevloc::firmware
