// Watches whether every thread makes progress, feeds systemd's watchdog and drives the fault line.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/health_state.h"
#include "drivers/clock/clock.h"
#include "firmware/devices/fault_line.h"
#include "firmware/runtime/service_notifier.h"
#include "firmware/threads/heartbeat.h"

namespace bevloc::firmware {

class Appliance;

/// Judges one heartbeat by the time of its latest change. One thread.
class HeartbeatWatch {
 public:
  /// `heartbeat` must outlive this.
  explicit HeartbeatWatch(const Heartbeat& heartbeat) : heartbeat_(&heartbeat) {}

  /// Returns whether the thread has not beaten within its deadline. A thread that has ended does
  /// not hang.
  bool hangs(Time now);
  bool has_moved() const { return heartbeat_->count() > 0 || heartbeat_->ended(); }

 private:
  const Heartbeat* heartbeat_;
  uint64_t count_ = 0;
  std::optional<Time> moved_;  ///< when the count last changed
};

/// Feeds systemd's watchdog only while every thread beats within its deadline. So the feeding ends
/// at the latest one second after a thread has stopped. If this is a camera's thread that starts or
/// stops its camera, the feeding ends after about ten seconds. Sends READY when every thread has
/// beaten once and none hangs. The fault line is active before READY, while a thread hangs and in
/// FAULT. Each step sets it first, so that nothing else can prevent this.
///
/// Thread-bound: watch() is called before the first step(), and step() from the watchdog thread.
/// The rest is readable from any thread.
class Watchdog {
 public:
  /// The period of step() on the machine's clock.
  static constexpr Duration kPeriod = std::chrono::milliseconds(100);

  /// `state` is that of the appliance. `fault` is null without a fault line. Both must outlive
  /// this.
  explicit Watchdog(const std::atomic<HealthState>& state, FaultLine* fault = nullptr)
      : state_(state), fault_(fault) {}

  /// Watches one thread. There may be at most 32 threads in all. `heartbeat` must outlive this.
  void watch(std::string name, const Heartbeat& heartbeat);
  /// Watches the threads of all stages. `appliance` must outlive this.
  void watch_stages(const Appliance& appliance);

  void step(Time now);

  /// The names of the threads that hang, separated by commas.
  std::string hung() const;
  const Heartbeat& heartbeat() const { return heartbeat_; }

 private:
  struct Watched {
    std::string name;
    HeartbeatWatch watch;
  };

  const std::atomic<HealthState>& state_;
  FaultLine* fault_;
  ServiceNotifier notifier_;
  std::vector<Watched> threads_;
  std::atomic<uint32_t> hung_{0};  ///< bit i is set if threads_[i] hangs
  bool ready_ = false;
  Heartbeat heartbeat_;
};

/// Starts the watchdog thread. It steps `watchdog` until it is asked to stop, so that a supervisor
/// that hangs is noticed, too. At its end it sets the fault line. All arguments must outlive the
/// result.
std::jthread start_watchdog(Watchdog& watchdog, FaultLine& fault, drivers::Clock& clock);

}  // namespace bevloc::firmware
