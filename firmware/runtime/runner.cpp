#include "firmware/runtime/runner.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <deque>
#include <string>
#include <thread>

#include <spdlog/spdlog.h>

#include "can/messages/localizer_messages.h"

namespace bevloc::firmware {
namespace {

/// Longest wait of a thread before it checks whether to end.
constexpr Duration kPatience = std::chrono::milliseconds(50);
constexpr Duration kBusCycle = std::chrono::milliseconds(can::kSolutionCycleMs);
constexpr Duration kSupervisionPeriod = std::chrono::milliseconds(100);
/// The longest wait for the end of all threads. Each ends after kPatience and one step. systemd
/// kills the daemon after 5 s (TimeoutStopSec=). The thread sanitizer makes a step of vision some
/// hundred times slower.
#ifdef __SANITIZE_THREAD__
constexpr Duration kEndPatience = std::chrono::seconds(60);
#else
constexpr Duration kEndPatience = std::chrono::seconds(4);
#endif

void publish(Appliance& appliance) {
  appliance.estimation().tick(appliance.clock());
  appliance.heartbeats().can_out.beat();
}

void publish_on_cycle(Appliance& appliance, const std::atomic<bool>& running) {
  Time due = appliance.clock().now();
  while (running) {
    appliance.clock().sleep_until(due);
    publish(appliance);
    const Time now = appliance.clock().now();
    due += kBusCycle;
    // After a stall, continue from now instead of sending a burst.
    if (due < now) due = now;
  }
}

void act_when_due(drivers::Clock& clock, const Companion& companion,
                  const std::atomic<bool>& running) {
  while (running) {
    clock.sleep_until(std::min(companion.next_due(), clock.now() + kPatience));
    companion.act(clock.now());
  }
}

/// A thread that says when it has ended, because a join has no timeout.
class EndingThread {
 public:
  template <typename Work>
  EndingThread(std::string name, Work work)
      : name_(std::move(name)), thread_([this, work = std::move(work)] {
          work();
          ended_ = true;
        }) {}

  bool ended() const { return ended_; }
  const std::string& name() const { return name_; }

 private:
  const std::string name_;
  std::atomic<bool> ended_{false};
  std::jthread thread_;
};

/// The threads are in a deque, because a thread cannot be moved.
using Threads = std::deque<EndingThread>;

/// The threads run while this object exists. Its destruction, also by an exception, makes them end.
/// Declare it after the threads, because their destruction waits for their end.
class Running {
 public:
  Running(Appliance& appliance, std::atomic<bool>& running)
      : appliance_(appliance), running_(running) {
    running_ = true;
  }
  ~Running() {
    running_ = false;
    appliance_.close();
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

 private:
  Appliance& appliance_;
  std::atomic<bool>& running_;
};

void capture(CaptureStage& stage, const std::atomic<bool>& running) {
  while (running && stage.step(kPatience)) {
  }
  stage.stop();
  stage.heartbeat().end();
}

void start_stages(Appliance& appliance, Realtime& realtime, const std::atomic<bool>& running,
                  Threads& threads) {
  StageHeartbeats& heartbeats = appliance.heartbeats();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const std::string name = fmt::format("cam-{}", kCameraNames[camera]);
    threads.emplace_back(name, [&stage = appliance.capture()[camera], name, &realtime, &running] {
      realtime.begin_thread(ThreadRole::kCapture, name);
      capture(stage, running);
    });
  }
  threads.emplace_back("vision", [&] {
    realtime.begin_thread(ThreadRole::kVision, "vision");
    while (running) {
      heartbeats.vision.beat();
      appliance.vision().step(appliance.clock(), kPatience);
    }
  });
  threads.emplace_back("can-in", [&] {
    realtime.begin_thread(ThreadRole::kCan, "can-in");
    while (running) {
      heartbeats.can_in.beat();
      appliance.vehicle_input().step(appliance.clock(), kPatience);
    }
  });
  if (GnssStage* gnss = appliance.gnss(); gnss != nullptr) {
    threads.emplace_back("gnss", [gnss, &heartbeats, &running] {
      name_this_thread("gnss");
      while (running) {
        heartbeats.gnss.beat();
        gnss->step(kPatience);
      }
    });
  }
  threads.emplace_back("can-out", [&] {
    realtime.begin_thread(ThreadRole::kCan, "can-out");
    publish_on_cycle(appliance, running);
  });
}

void start_companion(drivers::Clock& clock, const Companion& companion,
                     const std::atomic<bool>& running, Threads& threads) {
  threads.emplace_back("sim-vehicle", [&] {
    name_this_thread("sim-vehicle");
    act_when_due(clock, companion, running);
  });
  threads.emplace_back("sim-judge", [&] {
    name_this_thread("sim-judge");
    while (running) companion.listen(kPatience);
  });
}

/// Waits until the threads for which `wanted` is true have ended, but not longer than until
/// `give_up`. Returns the names of those that have not ended.
template <typename Wanted>
std::string wait_for_end(const Threads& threads, std::chrono::steady_clock::time_point give_up,
                         Wanted wanted) {
  std::string names;
  for (const EndingThread& thread : threads) {
    if (!wanted(thread.name())) continue;
    while (!thread.ended() && std::chrono::steady_clock::now() < give_up) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (!thread.ended()) names += (names.empty() ? "" : ", ") + thread.name();
  }
  return names;
}

/// Receives the confirmations of the last cycle. Without them the bus would hold back the sign-off.
void receive_confirmations(Appliance& appliance) {
  constexpr int kMostTries = 20;
  const auto waits = [&] {
    const can::BusCounters counters = appliance.bus().counters();
    return counters.confirmed > 0 && counters.confirmed < counters.sent;
  };
  for (int tries = 0; tries == 0 || (waits() && tries < kMostTries); ++tries) {
    appliance.vehicle_input().step(appliance.clock(), std::chrono::milliseconds(1));
  }
}

/// Sends LOST on the bus. Waits for the threads of the bus only, because another one may hang.
void sign_off(Appliance& appliance, const Threads& threads,
              std::chrono::steady_clock::time_point give_up) {
  const auto has_ended = [&](const char* name) {
    return wait_for_end(threads, give_up, [&](const auto& other) { return other == name; }).empty();
  };
  if (!has_ended("can-out")) return;
  if (has_ended("can-in")) receive_confirmations(appliance);
  appliance.estimation().sign_off(appliance.clock().now());
}

/// Exits the process without destroying the appliance, which the threads still use.
[[noreturn]] void exit_without(const std::string& names) {
  spdlog::error(
      "thread {} did not end within {} s; the process exits without it, and systemd starts it "
      "again",
      names, to_seconds(kEndPatience));
  std::this_thread::sleep_for(2 * kPatience);  // gives the log time to be written
  std::_Exit(kHungExitCode);
}

}  // namespace

void run_threads(Appliance& appliance, Realtime& realtime, const Companion* companion,
                 const Supervise& supervise) {
  std::atomic<bool> running{false};
  drivers::Clock& clock = appliance.clock();
  realtime.lock_memory();
  Threads threads;
  {
    const Running until_the_end(appliance, running);
    start_stages(appliance, realtime, running, threads);
    if (companion != nullptr) start_companion(clock, *companion, running, threads);
    Time next = clock.now();
    do {
      // After a stall, continue from now instead of supervising in a burst.
      next = std::max(next + kSupervisionPeriod, clock.now());
      clock.sleep_until(next);
    } while (supervise(clock.now()));
  }
  const auto give_up = std::chrono::steady_clock::now() + kEndPatience;
  sign_off(appliance, threads, give_up);
  const std::string hung = wait_for_end(threads, give_up, [](const auto&) { return true; });
  if (!hung.empty()) exit_without(hung);
}

void run_lockstep(Appliance& appliance, drivers::VirtualClock& clock, const Companion* companion,
                  const Supervise& supervise) {
  Time next_supervision = clock.now();
  for (bool running = true; running; clock.advance(kBusCycle)) {
    const Time now = clock.now();
    if (companion != nullptr) companion->act(now);
    appliance.vehicle_input().step(clock, Duration::zero());
    appliance.heartbeats().can_in.beat();
    for (CaptureStage& stage : appliance.capture()) stage.step(Duration::zero());
    appliance.vision().step(clock, Duration::zero());
    appliance.heartbeats().vision.beat();
    publish(appliance);
    if (companion != nullptr) companion->listen(Duration::zero());
    if (now >= next_supervision) {
      next_supervision = now + kSupervisionPeriod;
      running = supervise(now);
    }
  }
  for (CaptureStage& stage : appliance.capture()) stage.stop();
  appliance.estimation().sign_off(clock.now());
}

}  // namespace bevloc::firmware
