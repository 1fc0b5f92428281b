// Watches that every stage moves, and tells the service manager.
#pragma once

#include <array>
#include <optional>

#include "firmware/appliance.h"
#include "firmware/realtime.h"
#include "firmware/service_notifier.h"

namespace bevloc::firmware {

/// What a person wants to know at a glance.
struct ApplianceView {
  State state = State::kInit;
  can::WhyMask why;
  int cameras = 0;  ///< in the latest frameset
  can::BusCondition bus;
  double rate_hz = 0.0;       ///< framesets localized per second, over the last second or so
  bool stalled = false;       ///< a stage has not moved for a second
  int realtime_refusals = 0;  ///< settings of the section `realtime` that the kernel refused
  /// By how much each camera is faster than the median camera; 0 unless that is certain.
  std::array<double, kCameraCount> drift_ppm{};
  CameraMask frozen;  ///< cameras whose picture stands still while the vehicle drives
};

/// Thread: the supervising one, about ten times a second.
class Supervisor {
 public:
  Supervisor(const Appliance& appliance, const Realtime& realtime)
      : appliance_(appliance), realtime_(realtime) {}

  /// The watchdog is fed only if vision and estimation have both moved since the last time: a
  /// supervisor that is alive proves nothing about the stages.
  void step(Time now);
  void finish() { notifier_.stopping(); }

  const ApplianceView& view() const { return view_; }

 private:
  void update_rate(Time now);
  void watch_stages(Time now);
  std::string status_text() const;

  const Appliance& appliance_;
  const Realtime& realtime_;
  ServiceNotifier notifier_;
  ApplianceView view_;
  bool ready_ = false;
  uint64_t last_ticks_ = 0;
  uint64_t last_steps_ = 0;
  std::optional<Time> moved_;  ///< when all stages were last seen moving
  Time rate_since_ = Time::min();
  uint64_t framesets_then_ = 0;
};

}  // namespace bevloc::firmware
