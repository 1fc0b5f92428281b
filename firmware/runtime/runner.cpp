#include "firmware/runtime/runner.h"

#include <atomic>
#include <thread>
#include <vector>

#include "can/messages/localizer_messages.h"

namespace bevloc::firmware {
namespace {

/// Longest wait of a thread before it checks whether to end.
constexpr Duration kPatience = std::chrono::milliseconds(50);
constexpr Duration kBusCycle = std::chrono::milliseconds(can::kSolutionCycleMs);
constexpr Duration kSupervisionPeriod = std::chrono::milliseconds(100);

void publish_on_cycle(Appliance& appliance, const std::atomic<bool>& running) {
  Time due = appliance.clock().now();
  while (running) {
    appliance.clock().sleep_until(due);
    const Time now = appliance.clock().now();
    appliance.estimation().tick(now);
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

using Threads = std::vector<std::jthread>;

void start_stages(Appliance& appliance, Realtime& realtime, const std::atomic<bool>& running,
                  Threads& threads) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    threads.emplace_back([&stage = appliance.capture()[camera], camera, &realtime, &running] {
      realtime.begin_thread(ThreadRole::kCapture, fmt::format("cam-{}", kCameraNames[camera]));
      while (running && stage.step(kPatience)) {
      }
      stage.stop();
    });
  }
  threads.emplace_back([&] {
    realtime.begin_thread(ThreadRole::kVision, "vision");
    while (running) appliance.vision().step(appliance.clock(), kPatience);
  });
  threads.emplace_back([&] {
    realtime.begin_thread(ThreadRole::kCan, "can-in");
    while (running) appliance.vehicle_input().step(kPatience);
  });
  threads.emplace_back([&] {
    realtime.begin_thread(ThreadRole::kCan, "can-out");
    publish_on_cycle(appliance, running);
  });
}

void start_companion(drivers::Clock& clock, const Companion& companion,
                     const std::atomic<bool>& running, Threads& threads) {
  threads.emplace_back([&] {
    name_this_thread("sim-vehicle");
    act_when_due(clock, companion, running);
  });
  threads.emplace_back([&] {
    name_this_thread("sim-judge");
    while (running) companion.listen(kPatience);
  });
}

}  // namespace

void run_threads(Appliance& appliance, Realtime& realtime, const Companion* companion,
                 const Supervise& supervise) {
  std::atomic<bool> running{true};
  drivers::Clock& clock = appliance.clock();
  realtime.lock_memory();
  Threads threads;
  start_stages(appliance, realtime, running, threads);
  if (companion != nullptr) start_companion(clock, *companion, running, threads);
  Time next = clock.now();
  do {
    next += kSupervisionPeriod;
    clock.sleep_until(next);
  } while (supervise(clock.now()));
  running = false;
  appliance.close();
  threads.clear();
  // Receives the confirmations of the last cycle; without them the bus would hold back the
  // sign-off.
  appliance.vehicle_input().step(Duration::zero());
  appliance.estimation().sign_off(clock.now());
}

void run_lockstep(Appliance& appliance, drivers::VirtualClock& clock, const Companion* companion,
                  const Supervise& supervise) {
  Time next_supervision = clock.now();
  for (bool running = true; running; clock.advance(kBusCycle)) {
    const Time now = clock.now();
    if (companion != nullptr) companion->act(now);
    appliance.vehicle_input().step(Duration::zero());
    for (CaptureStage& stage : appliance.capture()) stage.step(Duration::zero());
    appliance.vision().step(clock, Duration::zero());
    appliance.estimation().tick(now);
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
