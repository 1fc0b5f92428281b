// Checks that every stage makes progress, and reports the appliance state to the service manager.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "firmware/runtime/appliance.h"
#include "firmware/runtime/realtime.h"
#include "firmware/runtime/service_notifier.h"

namespace bevloc::firmware {

/// State of the appliance, for log, LED, service status and progress line.
struct ApplianceView {
  HealthState state = HealthState::kInit;
  WhyMask why;
  int cameras = 0;  ///< used in the latest frameset
  can::BusCondition bus;
  double rate_hz = 0.0;       ///< framesets per second, averaged over about one second
  bool stalled = false;       ///< a stage has made no progress for one second
  int realtime_refusals = 0;  ///< settings of the section `realtime` that the kernel refused
  std::array<double, kCameraCount> drift_ppm{};  ///< as in SynchronyCounters
  CameraMask frozen;                             ///< as in VisionCounters, also the next three
  CameraMask dark;
  CameraMask blinded;
  CameraMask dirty;
  bool network_fault = false;
};

/// Thread-bound: called from the supervising thread.
class Supervisor {
 public:
  /// Both must outlive the supervisor.
  Supervisor(const Appliance& appliance, const Realtime& realtime)
      : appliance_(appliance), realtime_(realtime) {}

  /// Updates the view and feeds the watchdog. To be called about ten times per second. The watchdog
  /// is fed only if both vision and estimation have made progress since the last call.
  void step(Time now);
  /// Reports to the service manager that the appliance stops.
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
  std::optional<Time> last_progress_;  ///< when all stages had last made progress
  Time rate_since_ = Time::min();
  uint64_t framesets_at_rate_start_ = 0;
};

}  // namespace bevloc::firmware
