// Collects the state of the appliance and reports it to the service manager.
#pragma once

#include <array>
#include <string>

#include "firmware/runtime/appliance.h"
#include "firmware/runtime/service_notifier.h"
#include "firmware/runtime/watchdog.h"
#include "firmware/threads/realtime.h"

namespace bevloc::firmware {

/// The state of the appliance, for log, LED, service status, progress line and live server.
struct ApplianceView {
  HealthState state = HealthState::kInit;
  WhyMask why;
  uint64_t lost = 0;  ///< how often the pose was lost
  WhyMask lost_why;   ///< reasons of the latest loss
  int cameras = 0;    ///< number of cameras that the latest frameset used
  can::BusCondition bus;
  double rate_hz = 0.0;       ///< framesets per second, averaged over about one second
  std::string hung;           ///< names of the threads that hang, separated by commas
  int realtime_refusals = 0;  ///< settings of the section `realtime` that the kernel refused
  std::array<double, kCameraCount> drift_ppm{};  ///< as in SynchronyCounters
  CameraMask frozen;                             ///< as in VisionCounters, like the next four
  CameraMask dark;
  CameraMask blinded;
  CameraMask dirty;
  CameraMask calibration_fault;
  int stamp_offset_ms = 0;  ///< as in EstimationCounters, like the next two
  int gnss_lag_ms = 0;
  std::array<int, 2> map_offset_cm{};
};

/// Thread-bound: called from the supervising thread; heartbeat() is readable from any thread.
class Supervisor {
 public:
  /// All arguments must outlive the supervisor.
  Supervisor(const Appliance& appliance, const Realtime& realtime, const Watchdog& watchdog)
      : appliance_(appliance),
        realtime_(realtime),
        watchdog_(watchdog),
        watchdog_watch_(watchdog.heartbeat()) {}

  /// Updates the view. Call it about ten times per second.
  void step(Time now);
  /// Reports to the service manager that the appliance stops.
  void finish() { notifier_.stopping(); }

  const Heartbeat& heartbeat() const { return heartbeat_; }
  const ApplianceView& view() const { return view_; }

 private:
  void update_rate(Time now);
  std::string hung_threads(Time now);
  std::string status_text() const;

  const Appliance& appliance_;
  const Realtime& realtime_;
  const Watchdog& watchdog_;
  HeartbeatWatch watchdog_watch_;  ///< watches the watchdog's own thread
  Heartbeat heartbeat_;
  ServiceNotifier notifier_;
  ApplianceView view_;
  Time rate_since_ = Time::min();
  uint64_t framesets_at_rate_start_ = 0;
};

}  // namespace bevloc::firmware
