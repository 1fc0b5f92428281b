// Watches that every stage moves, and tells the service manager.
#pragma once

#include "firmware/appliance.h"
#include "firmware/service_notifier.h"

namespace bevloc::firmware {

/// What a person wants to know at a glance.
struct ApplianceView {
  State state = State::kInit;
  can::WhyMask why;
  int cameras = 0;       ///< in the latest frameset
  double rate_hz = 0.0;  ///< framesets localized per second, over the last second or so
};

/// Thread: the supervising one, about ten times a second.
class Supervisor {
 public:
  explicit Supervisor(const Appliance& appliance) : appliance_(appliance) {}

  /// The watchdog is fed only if vision and estimation have both moved since the last time: a
  /// supervisor that is alive proves nothing about the stages.
  void step(Time now);
  void finish() { notifier_.stopping(); }

  const ApplianceView& view() const { return view_; }

 private:
  void update_rate(Time now);

  const Appliance& appliance_;
  ServiceNotifier notifier_;
  ApplianceView view_;
  bool ready_ = false;
  uint64_t last_ticks_ = 0;
  uint64_t last_steps_ = 0;
  Time rate_since_ = Time::min();
  uint64_t framesets_then_ = 0;
};

}  // namespace bevloc::firmware
