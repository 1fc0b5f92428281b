#include "firmware/runtime/watchdog.h"

#include <cassert>
#include <condition_variable>
#include <mutex>

#include "firmware/runtime/appliance.h"
#include "firmware/threads/realtime.h"

namespace bevloc::firmware {

bool HeartbeatWatch::hangs(Time now) {
  // The deadline comes first. Otherwise the thread could beat in between, and the short deadline of
  // that beat would be applied to the long time before it.
  const Duration deadline = heartbeat_->deadline();
  const uint64_t count = heartbeat_->count();
  if (!moved_ || count != count_) {
    count_ = count;
    moved_ = now;
  }
  return !heartbeat_->ended() && now - *moved_ > deadline;
}

void Watchdog::watch_stages(const Appliance& appliance) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    watch(fmt::format("cam-{}", kCameraNames[camera]), appliance.capture()[camera].heartbeat());
  }
  const StageHeartbeats& stages = appliance.heartbeats();
  watch("vision", stages.vision);
  watch("can-in", stages.can_in);
  watch("can-out", stages.can_out);
  if (appliance.gnss() != nullptr) watch("gnss", stages.gnss);
}

void Watchdog::watch(std::string name, const Heartbeat& heartbeat) {
  assert(threads_.size() < 32);
  threads_.push_back({std::move(name), HeartbeatWatch(heartbeat)});
}

void Watchdog::step(Time now) {
  heartbeat_.beat();
  uint32_t hung = 0;
  bool all_moved = true;
  for (size_t i = 0; i < threads_.size(); ++i) {
    if (threads_[i].watch.hangs(now)) hung |= 1u << i;
    all_moved = all_moved && threads_[i].watch.has_moved();
  }
  const bool becomes_ready = !ready_ && all_moved && hung == 0;
  ready_ = ready_ || becomes_ready;
  if (fault_ != nullptr) {
    fault_->set(!ready_ || hung != 0 || state_ == HealthState::kFault, now);
  }
  hung_ = hung;
  if (becomes_ready) notifier_.ready();
  if (ready_ && hung == 0) notifier_.feed_watchdog();
}

std::string Watchdog::hung() const {
  std::string names;
  const uint32_t hung = hung_;
  for (size_t i = 0; i < threads_.size(); ++i) {
    if ((hung & (1u << i)) == 0) continue;
    if (!names.empty()) names += ", ";
    names += threads_[i].name;
  }
  return names;
}

std::jthread start_watchdog(Watchdog& watchdog, FaultLine& fault, drivers::Clock& clock) {
  return std::jthread([&](const std::stop_token& stop) {
    name_this_thread("watchdog");
    std::mutex mutex;
    std::condition_variable_any stopped;
    std::unique_lock lock(mutex);
    while (
        !stopped.wait_for(lock, stop, Watchdog::kPeriod, [&] { return stop.stop_requested(); })) {
      watchdog.step(clock.now());
    }
    fault.set(true, clock.now());
  });
}

}  // namespace bevloc::firmware
